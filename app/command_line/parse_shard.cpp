// Environment of array jobs: sbatch(1), "OUTPUT ENVIRONMENT VARIABLES".
#include "app/command_line/parse_shard.h"

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "app/process/usage_error.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

std::optional<std::int64_t> slurm_number(const std::string& name) {
  const char* const text = std::getenv(("SLURM_ARRAY_TASK_" + name).c_str());
  return text ? integer_from(text) : std::nullopt;
}

std::int64_t required_slurm_number(const std::string& name) {
  if (const std::optional<std::int64_t> number = slurm_number(name)) return *number;
  throw UsageError("--shard slurm: SLURM_ARRAY_TASK_" + name +
                   " is not set to a number, expected to run in an array job of Slurm");
}

Shard slurm_shard() {
  const std::int64_t task = required_slurm_number("ID");
  const std::int64_t least = required_slurm_number("MIN");
  const std::int64_t most = required_slurm_number("MAX");
  const std::int64_t step = required_slurm_number("STEP");
  const bool ordered = 0 <= least && least <= task && task <= most && step > 0;
  const bool regular = ordered && (task - least) % step == 0 && (most - least) % step == 0;
  const std::uint64_t count = regular ? static_cast<std::uint64_t>((most - least) / step) + 1 : 0;
  const std::optional<std::int64_t> announced = slurm_number("COUNT");
  if (!regular || (announced && static_cast<std::uint64_t>(*announced) != count)) {
    throw UsageError(
        "--shard slurm: the array's task numbers have gaps, expected a regular range such as --array=1-100");
  }
  return {static_cast<std::uint64_t>((task - least) / step) + 1, count};
}

}  // namespace

Shard parse_shard(const std::string& text) {
  if (text == "slurm") return slurm_shard();
  const std::size_t slash = text.find('/');
  const std::optional<std::int64_t> index = integer_from(std::string_view(text).substr(0, slash));
  const std::optional<std::int64_t> count =
      slash == std::string::npos ? std::nullopt : integer_from(std::string_view(text).substr(slash + 1));
  if (index && count && 1 <= *index && *index <= *count) {
    return {static_cast<std::uint64_t>(*index), static_cast<std::uint64_t>(*count)};
  }
  throw UsageError("--shard " + text + ": expected I/N with 1 <= I <= N, or slurm");
}

}  // namespace raycone
