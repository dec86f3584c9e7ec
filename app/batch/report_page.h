// `raycone report`: a page about a batch.
#pragma once

#include "app/options/batch_command.h"

namespace raycone {

// Writes it from the results of the batch and all its shards. Throws InputError where there are none, OutputError.
void write_report_page(const ReportCommand& command);

}  // namespace raycone
