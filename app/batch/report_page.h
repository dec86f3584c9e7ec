// `raycone report`: a page about a batch.
#pragma once

#include <cstddef>

#include "app/options/batch_command.h"

namespace raycone {

// Writes it from the results of the batch and all its shards, and returns the number of their meshes. Throws InputError
// where there are none, OutputError.
std::size_t write_report_page(const ReportCommand& command);

}  // namespace raycone
