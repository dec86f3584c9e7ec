// What was asked for, as files keep it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"

namespace raycone {

// Defaults that commands do not share.
struct OwnDefaults {
  std::string_view dtype{};  // nothing where there is no such option
  std::string_view field = "--field=winding";
};
inline constexpr OwnDefaults kDefaultsOfLattices{.dtype = "--dtype=f32"};
inline constexpr OwnDefaults kDefaultsOfPoints{.dtype = "--dtype=f64"};
inline constexpr OwnDefaults kDefaultsOfDrawnPoints{.dtype = "--dtype=f64", .field = ""};  // more is asked about them

// Whether "--name=value" holds where it is not given.
[[nodiscard]] bool is_default(const std::string& option, const OwnDefaults& own);

// The value of --like, FILE[:NAME], without the directory: results depend on what the grid is, not on where.
[[nodiscard]] std::string like_without_directory(const std::string& value);

// The options that results depend on, "--name=value" or "--name", by name: not those that say where results go, what a
// run may use or what it prints, and not what would hold anyway. Files are named without their directories. `known`:
// the command's.
[[nodiscard]] std::vector<std::string> given_options(const Values& values, const OptionNames& known,
                                                     const OwnDefaults& own = {});

}  // namespace raycone
