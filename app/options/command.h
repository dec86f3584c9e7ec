// A command line as data: plain values that need no parser. What needs no file has been checked.
#pragma once

#include <string>
#include <variant>

#include "app/options/batch_command.h"
#include "app/options/info_command.h"
#include "app/options/lattice_command.h"
#include "app/options/points_command.h"
#include "app/options/slice_command.h"
#include "app/options/surface_command.h"

namespace raycone {

// --help and --version: their text is a result.
struct PrintCommand {
  std::string text;
};

using Command = std::variant<LatticeCommand, PointsCommand, SliceCommand, SurfaceCommand, InfoCommand, BatchCommand,
                             ReportCommand, PrintCommand>;

}  // namespace raycone
