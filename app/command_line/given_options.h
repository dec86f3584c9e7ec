// What was asked for, as files keep it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"

namespace raycone {

// Defaults that commands do not share.
inline constexpr std::string_view kDefaultOfLattices = "--dtype=f32";
inline constexpr std::string_view kDefaultOfPoints = "--dtype=f64";

// Whether "--name=value" holds where it is not given. `own_default`: one of those above, or nothing. `draws`: whether
// --sample is there.
[[nodiscard]] bool is_default(const std::string& option, std::string_view own_default, bool draws);

// The value of --like, FILE[:NAME], without the directory: results depend on what the grid is, not on where.
[[nodiscard]] std::string like_without_directory(const std::string& value);

// The options that results depend on, "--name=value" or "--name", by name: not those that say where results go, what a
// run may use or what it prints, and not what would hold anyway. Files are named without their directories. `known`:
// the command's. `own_default`: as above.
[[nodiscard]] std::vector<std::string> given_options(const Values& values, const OptionNames& known,
                                                     std::string_view own_default = {});

}  // namespace raycone
