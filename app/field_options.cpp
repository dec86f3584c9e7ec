#include "app/field_options.h"

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "app/parse_value.h"

namespace raycone {
namespace {

const std::set<std::string_view> kLaterFields{"inside", "density", "sdf"};

}  // namespace

OptionGroup field_group() {
  return {"Field",
          {{"--field", "winding", "The winding number w (default)"},
           {"--diagnostics", "", "Also crossings, degenerate, on_surface, error_bound of each value"},
           {"--verify", "N", "Check N samples against direct sums in 113 bits: 2.7 us per triangle and sample"}}};
}

// Exact is all there is: 0, the default, is accepted for scripts that state it.
OptionGroup unlisted_field_group() { return {"", {{"--tolerance", "T", ""}}}; }

OptionNames later_field_options() { return {{"--rule", "--band", "--engine", "--simd", "--depfile"}, {}}; }

FieldOptions parse_field(const Values& values) {
  if (values.given("--field")) {
    const std::string text = values.text("--field");
    const std::vector<std::string_view> fields = items_of(text);
    for (const std::string_view field : fields) {
      if (field != "winding" && !kLaterFields.contains(field)) invalid("--field", text, "winding");
    }
    if (text != "winding") not_available("--field " + text);
  }
  if (values.given("--tolerance")) {
    const std::optional<double> tolerance = number_from(values.text("--tolerance"));
    if (!tolerance || *tolerance < 0.0) invalid("--tolerance", values.text("--tolerance"), "0");
    if (*tolerance > 0.0) not_available("--tolerance " + values.text("--tolerance"));
  }
  FieldOptions options;
  options.diagnostics = values.given("--diagnostics");
  constexpr std::int64_t kMaxVerified = 1'000'000'000;
  if (values.given("--verify")) {
    options.verify = static_cast<std::uint64_t>(values.integer("--verify", 1, kMaxVerified));
  }
  return options;
}

}  // namespace raycone
