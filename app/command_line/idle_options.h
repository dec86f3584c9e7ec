// Options that would have no effect on what is asked for are usage errors. Those are harmless that say how to run
// (--threads, --quiet, --engine, ...) or what must not happen (--no-clobber, --strict).
#pragma once

#include "app/command_line/values.h"
#include "app/options/field_options.h"
#include "app/options/lattice_command.h"
#include "app/options/output_options.h"
#include "app/options/points_command.h"

namespace raycone {

// `values` are those that the command was made of. All throw UsageError.
void refuse_idle_options(const Values& values, const LatticeCommand& command);
void refuse_idle_options(const Values& values, const PointsCommand& command);

// Parts of them for other commands: options of fields, and of files. `expected`: the command's fields that have a rule.
void refuse_idle_rule(const Values& values, const FieldOptions& field, const char* expected);
void refuse_idle_parts(const Values& values, const FieldOptions& field);
void refuse_idle_depfile(const Values& values, const OutputFiles& output);

// Of a batch that writes no outputs.
void refuse_options_of_outputs(const Values& values);

}  // namespace raycone
