#include "app/command_line/lattice_options.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/command_line/common_options.h"
#include "app/command_line/field_options.h"
#include "app/command_line/given_options.h"
#include "app/command_line/idle_options.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"
#include "io/files/ascii.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

std::variant<LongestSide, SampleCounts> parse_resolution(const std::string& text) {
  constexpr std::int64_t kMaxCount = std::int64_t{1} << 53;
  const std::vector<std::int64_t> counts = integers_from(text).value_or(std::vector<std::int64_t>());
  const bool valid = std::ranges::all_of(counts, [](std::int64_t n) { return n >= 1 && n <= kMaxCount; });
  if (valid && counts.size() == 1) return LongestSide{counts[0]};
  if (valid && counts.size() == 3) return SampleCounts{{counts[0], counts[1], counts[2]}};
  invalid("--resolution", text, "N or NX,NY,NZ, integers of at least 1");
}

VoxelSize parse_voxel_size(const std::string& text) {
  const std::vector<double> sizes = numbers_from(text).value_or(std::vector<double>());
  const bool valid = std::ranges::all_of(sizes, [](double size) { return size > 0.0; });
  if (valid && sizes.size() == 1) return {{sizes[0], sizes[0], sizes[0]}};
  if (valid && sizes.size() == 3) return {{sizes[0], sizes[1], sizes[2]}};
  invalid("--voxel-size", text, "H or HX,HY,HZ, positive numbers");
}

// A file name may contain colons: the grid's name starts behind the last ".vdb:", in any case.
GridReference parse_like(const std::string& text) {
  const std::size_t end = lower_case(text).rfind(".vdb:");
  if (end == std::string::npos) return {text, ""};
  return {text.substr(0, end + 4), text.substr(end + 5)};
}

// An array or image of a lattice has one axis per axis of the lattice.
void check_one_field(const LatticeCommand& command) {
  const FormatTraits& format = traits_of(command.encoding.format);
  const auto refuse = [&](const std::string& what, FormatTraits::Content content) {
    if (format.holds(content)) return;
    throw UsageError(what + ": " + std::string(format.name) + " holds one number per sample, expected " +
                     enumerated(names_of(formats_that_hold(content)), " or "));
  };
  if (command.field.diagnostics) refuse("--diagnostics", FormatTraits::kSeveralFields);
  if (command.field.fields.size() > 1) refuse("several fields", FormatTraits::kSeveralFields);
  if (command.field.has(Field::kGradient)) refuse("--field gradient", FormatTraits::kVectors);
}

// On text no --dtype has an effect, which is said elsewhere.
void check_halves(const FieldEncoding& encoding) {
  if (encoding.precision != Precision::kHalf || is_text(encoding.format)) return;
  if (traits_of(encoding.format).holds(FormatTraits::kHalves)) return;
  throw UsageError("--dtype f16: this format has no numbers of 16 bits, expected f32 or f64, or the format " +
                   enumerated(names_of(formats_that_hold(FormatTraits::kHalves)), " or "));
}

// NRRD alone leaves the choice.
void parse_compress(const Values& values, FieldEncoding& encoding) {
  encoding.compress = values.given("--compress") || encoding.format == FieldFormat::kNiftiGz;
  if (!values.given("--compress") || encoding.format == FieldFormat::kNrrd) return;
  throw UsageError("--compress: has no effect on this format, expected nrrd; .nii.gz is compressed anyway");
}

// A level set needs the band on the outside too. One that is not cut off has the lattice of the default band.
void make_room_for_band(const Values& values, LatticeCommand& command) {
  if (values.given("--padding") || values.given("--bounds") || values.given("--like")) return;
  constexpr double kMost = 1e6;
  const double band = std::isinf(command.field.band) ? FieldOptions{}.band : command.field.band;
  if (band > kMost) invalid("--band", values.text("--band"), "at most a million voxels");
  const auto samples = static_cast<std::int64_t>(std::ceil(band + 1));
  std::get<LatticeRequest>(command.lattice).padding = VoxelPadding{samples};
}

// What only grids of OpenVDB have.
void parse_grid_options(const Values& values, LatticeCommand& command) {
  FieldEncoding& encoding = command.encoding;
  values.exclude("--half", {"--double", "--dtype"});
  values.exclude("--double", {"--dtype"});
  for (const char* const name : {"--half", "--grid-name"}) {
    if (values.given(name) && encoding.format != FieldFormat::kVdb) {
      throw UsageError(std::string(name) + ": is for grids, expected the format vdb");
    }
  }
  if (values.given("--half")) encoding.precision = Precision::kHalf;
  if (!values.given("--grid-name")) return;
  encoding.grid_name = values.text("--grid-name");
  if (command.field.fields.size() > 1) {
    throw UsageError("--grid-name " + *encoding.grid_name + ": names a single grid, expected one field");
  }
  if (command.field.diagnostics && std::ranges::count(kDiagnosticNames, *encoding.grid_name) > 0) {
    invalid("--grid-name", *encoding.grid_name, "another name than the diagnostics'");
  }
}

}  // namespace

OptionGroup lattice_group() {
  return {"Lattice",
          {{"--bounds", "X0,Y0,Z0,X1,Y1,Z1", "Box to sample (default: the bounding box of the mesh)"},
           {"--padding", "P|Q%|Nv", "Widen the box by P, Q % of its longest side, or N voxels, on every side"},
           {"--resolution", "N|NX,NY,NZ", "Samples along the longest side (default: 64), or along x, y and z"},
           {"--voxel-size", "H|HX,HY,HZ", "Spacing of the samples; they lie at multiples of H"},
           {"--like", "GRID.vdb[:NAME]|FILE", "Use the lattice of an existing grid: VDB, NPZ, NRRD or NIfTI"},
           {"--centers", "", "Sample the centres of cells instead of their corners"}}};
}

Box parse_bounds(const std::string& text) {
  const std::optional<std::vector<double>> numbers = numbers_from(text);
  if (!numbers || numbers->size() != 6) invalid("--bounds", text, "six numbers X0,Y0,Z0,X1,Y1,Z1");
  const std::vector<double>& n = *numbers;
  const Box box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  for (int axis = 0; axis < 3; ++axis) {
    if (box.lower[axis] > box.upper[axis]) invalid("--bounds", text, "X0 <= X1, Y0 <= Y1, Z0 <= Z1");
  }
  return box;
}

std::variant<WorldPadding, VoxelPadding> parse_padding(const std::string& text) {
  if (text.ends_with('v')) {
    const std::optional<std::int64_t> samples = integer_from(std::string_view(text).substr(0, text.size() - 1));
    if (samples) return VoxelPadding{*samples};
  } else if (text.ends_with('%')) {
    const std::optional<double> percent = number_from(std::string_view(text).substr(0, text.size() - 1));
    if (percent) return WorldPadding{*percent, true};
  } else if (const std::optional<double> width = number_from(text)) {
    return WorldPadding{*width};
  }
  invalid("--padding", text, "a distance, a part of the longest side such as 5%, or a number of voxels such as 3v");
}

std::variant<LatticeRequest, GridReference> parse_lattice_request(const Values& values) {
  values.exclude("--like", {"--resolution", "--voxel-size", "--bounds", "--padding", "--centers"});
  values.exclude("--resolution", {"--voxel-size"});
  if (values.given("--like")) return parse_like(values.text("--like"));
  LatticeRequest request;
  if (values.given("--bounds")) request.bounds = parse_bounds(values.text("--bounds"));
  if (values.given("--padding")) request.padding = parse_padding(values.text("--padding"));
  if (values.given("--voxel-size")) request.sampling = parse_voxel_size(values.text("--voxel-size"));
  if (values.given("--resolution")) {
    std::visit([&](const auto& sampling) { request.sampling = sampling; },
               parse_resolution(values.text("--resolution")));
  }
  request.centers = values.given("--centers");
  return request;
}

CommandSpec lattice_spec() {
  OptionGroup output = output_group(joined(names_of(formats_that_hold(FormatTraits::kLattices)), "|"));
  output.options.push_back(
      {"--dtype", "f16|f32|f64", "Type of values in all formats but CSV; f16 in VDB, NPY, NPZ (default: f32)"});
  output.options.push_back({"--double", "", "The same as --dtype f64"});
  output.options.push_back({"--half", "", "The same as --dtype f16 (VDB only)"});
  output.options.push_back(pack_bits_option());
  output.options.push_back({"--compress", "", "Compress NRRD by gzip"});
  output.options.push_back({"--grid-name", "NAME", "Name of the grid in VDB (default: the field's)"});
  return {.name = "lattice",
          .description = "Sample a mesh on a regular grid, the lattice, and write a volume",
          .operands = {meshes_operand()},
          .groups = {mesh_group(), lattice_group(), field_group(), output, run_group()},
          .examples = {"raycone lattice bunny.obj -o bunny.vdb                     64 samples along the longest side",
                       "raycone lattice bunny.obj -o bunny.npy --resolution 50,50,50",
                       "raycone lattice part.stl -o part.vdb --voxel-size 0.5 --padding 3v",
                       "raycone lattice next.obj -o next.vdb --like bunny.vdb      on the lattice of another volume",
                       "raycone lattice femur.stl tibia.stl -o knee.nii.gz --field label",
                       "zcat scan.ply.gz | raycone lattice - -o - --format csv | head"}};
}

Command parse_lattice(const Values& values) {
  if (!values.given("--output")) throw UsageError("no output given, expected -o OUT" + help_hint("lattice"));
  LatticeCommand command;
  command.field = parse_field(values);
  command.mesh = parse_meshes(values, command.field);
  command.run = parse_run(values);
  command.lattice = parse_lattice_request(values);
  if (command.field.has_distance()) make_room_for_band(values, command);
  command.output = parse_output_files(values);
  command.encoding = parse_encoding(values, command.output, {.written = formats_that_hold(FormatTraits::kLattices)});
  if (values.given("--double")) command.encoding.precision = Precision::kDouble;
  parse_grid_options(values, command);
  check_one_field(command);
  check_halves(command.encoding);
  parse_compress(values, command.encoding);
  command.run.options = given_options(values, option_names(lattice_spec()), kDefaultsOfLattices);
  refuse_idle_options(values, command);
  return command;
}

}  // namespace raycone
