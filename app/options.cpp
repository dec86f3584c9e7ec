// Declaration of the commands for CLI11, which checks them and prints their help, and conversion of their values, which
// stay strings until here: CLI11's own conversions accept infinity and let list options swallow operands.
#include "app/options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <set>

#include "app/arguments.h"
#include "app/limits.h"
#include "app/parse_value.h"
#include "app/usage_error.h"
#include "app/version.h"

namespace raycone {
namespace {

// ---- What there is ---------------------------------------------------------------------------------------------

constexpr const char* kLatticeExamples = R"(Examples:
  raycone lattice bunny.obj -o bunny.vdb                     64 samples along the longest side
  raycone lattice bunny.obj -o bunny.npy --resolution 50,50,50
  raycone lattice part.stl -o part.vdb --voxel-size 0.5 --padding 3v
  raycone lattice next.obj -o next.vdb --like bunny.vdb      on the lattice of another volume
  zcat scan.ply.gz | raycone lattice - -o - --format csv | head)";

constexpr const char* kPointsExamples = R"(Examples:
  raycone points bunny.obj points.csv > values.csv
  raycone points bunny.obj points.npy -o values.npy
  raycone points bunny.obj cloud.ply -o values.csv
  raycone points bunny.obj table.tsv --columns 2,3,4
  echo 0 0.1 0 | raycone points bunny.obj -)";

constexpr const char* kInfoExamples = R"(Examples:
  raycone info bunny.obj
  raycone info bunny.obj --json | jq .exterior_edges
  raycone info model.glb --up y-to-z --weld 1e-6)";

constexpr const char* kOverview = R"(Examples:
  raycone info bunny.obj
  raycone lattice bunny.obj -o bunny.vdb
  raycone points bunny.obj points.csv > values.csv

Each command has its own help: raycone lattice --help
Exit status: 0 done, 1 usage, 2 input, 3 output, 4 limit, 6 internal error)";

// Options and commands that are promised but do not exist yet: they are recognised, and absent from the help.
const OptionNames kLaterFieldOptions{{"--rule", "--band", "--engine", "--simd", "--depfile"}, {}};
const OptionNames kLaterLatticeOptions{{"--grid-name"}, {"--half"}};
const OptionNames kLaterPointsOptions{{"--sample", "--seed", "--raw"}, {}};
const std::set<std::string_view> kLaterCommands{"slice", "batch", "report"};
const std::set<std::string_view> kLaterFields{"inside", "density", "sdf"};

void add_value(CLI::App& app, const char* group, const char* name, const char* value, const char* description) {
  app.add_option(name)->option_text(value)->description(description)->take_last()->group(group);
}

void add_flag(CLI::App& app, const char* group, const char* name, const char* description) {
  app.add_flag(name)->description(description)->group(group);
}

void add_operand(CLI::App& app, const char* name, const char* description) {
  app.add_option(name)->description(description)->required()->option_text(" ");
}

void add_mesh_options(CLI::App& app) {
  add_operand(app, "MESH", "OBJ, PLY, STL, OFF, glTF or GLB file; - for standard input");
  constexpr const char* kGroup = "Mesh";
  add_value(app, kGroup, "--mesh-format", "FORMAT", "obj, ply, stl, off, gltf or glb, for standard input");
  add_value(app, kGroup, "--weld", "exact|none|D", "Merge vertices at equal positions, or within D (default: exact)");
  add_value(app, kGroup, "--scale", "S", "Multiply all coordinates by S");
  add_value(app, kGroup, "--up", "y-to-z", "Turn (x, y, z) into (x, -z, y), as Blender does to glTF and OBJ");
}

void add_output_options(CLI::App& app, const char* formats) {
  constexpr const char* kGroup = "Output";
  add_value(app, kGroup, "-o,--output", "OUT", "File to write; - for standard output");
  add_value(app, kGroup, "--format", formats, "Format of OUT (default: by its extension, csv for -)");
  add_flag(app, kGroup, "--no-clobber", "Never replace an existing file");
  add_value(app, kGroup, "--report", "FILE.json", "Write what was done, for machines");
}

void add_field_options(CLI::App& app) {
  add_value(app, "Field", "--field", "winding", "The winding number w (default)");
  add_flag(app, "Field", "--diagnostics", "Also crossings, degenerate, on_surface, error_bound of each value");
  add_value(app, "Field", "--verify", "N",
            "Check N samples against direct sums in 113 bits: 2.7 us per triangle and sample");
  // Exact is all there is: 0, the default, is accepted for scripts that state it.
  add_value(app, "", "--tolerance", "T", "");
}

void add_run_options(CLI::App& app) {
  constexpr const char* kGroup = "Run";
  add_value(app, kGroup, "--threads", "T", "Threads (default: RAYCONE_THREADS, else the CPUs that may be used)");
  add_value(app, kGroup, "--memory-limit", "8G", "Refuse what needs more memory (default: what is available)");
  add_value(app, kGroup, "--timeout", "S", "Give up after S seconds");
  add_value(app, kGroup, "--progress", "always|never|auto", "Progress on standard error (default: on a terminal)");
  add_flag(app, kGroup, "--quiet", "Print errors only");
  add_flag(app, kGroup, "--strict", "Treat warnings about the mesh as errors");
  app.set_help_flag("-h,--help", "Print this help")->group(kGroup);
}

void add_later_options(CLI::App& app, const OptionNames& names) {
  for (const std::string& name : names.with_value) add_value(app, "", name.c_str(), "", "");
  for (const std::string& name : names.flags) add_flag(app, "", name.c_str(), "");
}

void declare_lattice(CLI::App& app) {
  add_mesh_options(app);
  constexpr const char* kGroup = "Lattice";
  add_value(app, kGroup, "--bounds", "X0,Y0,Z0,X1,Y1,Z1", "Box to sample (default: that of the mesh)");
  add_value(app, kGroup, "--padding", "P|Nv", "Widen the box by P, or by N voxels, on every side");
  add_value(app, kGroup, "--resolution", "N|NX,NY,NZ", "Samples along the longest side (64), or along each");
  add_value(app, kGroup, "--voxel-size", "H|HX,HY,HZ", "Samples at the multiples of H");
  add_value(app, kGroup, "--like", "GRID.vdb[:NAME]", "Transform and extent of an existing grid");
  add_flag(app, kGroup, "--centers", "Samples at the centres of cells instead of their corners");
  add_field_options(app);
  add_output_options(app, "vdb|csv|npy");
  add_flag(app, "Output", "--double", "64-bit values in VDB and NPY (default: 32-bit)");
  add_run_options(app);
  add_later_options(app, kLaterFieldOptions);
  add_later_options(app, kLaterLatticeOptions);
  app.footer(kLatticeExamples);
}

void declare_points(CLI::App& app) {
  add_mesh_options(app);
  add_operand(app, "POINTS", "CSV, TSV or blank-separated text, NPY or PLY file; - for text on standard input");
  add_value(app, "Points", "--columns", "A,B,C", "Columns of x, y, z in text, counted from 1");
  add_field_options(app);
  add_output_options(app, "csv|npy");
  add_run_options(app);
  add_later_options(app, kLaterFieldOptions);
  add_later_options(app, kLaterPointsOptions);
  app.footer(kPointsExamples);
}

void declare_info(CLI::App& app) {
  add_mesh_options(app);
  add_flag(app, "Output", "--json", "Print JSON");
  add_run_options(app);
  app.footer(kInfoExamples);
}

void declare_commands(CLI::App& root) {
  root.require_subcommand(1);
  root.get_formatter()->column_width(36);
  root.get_formatter()->label("Positionals", "Operands");
  root.get_formatter()->label("SUBCOMMAND", "COMMAND");
  root.set_help_flag("-h,--help", "Print this help");
  add_flag(root, "Options", "--version", "Print the versions of raycone and its libraries");
  root.footer(kOverview);
  const char* const group = "Commands";
  declare_lattice(*root.add_subcommand("lattice", "Values on a regular lattice")->group(group));
  declare_points(*root.add_subcommand("points", "Values at given points")->group(group));
  declare_info(*root.add_subcommand("info", "What a mesh is, and what evaluation will cost")->group(group));
}

// ---- Errors ----------------------------------------------------------------------------------------------------

[[noreturn]] void not_available(const std::string& what) { throw UsageError(what + ": not available yet"); }

[[noreturn]] void invalid(const std::string& name, const std::string& text, const std::string& expected) {
  throw UsageError(name + " " + text + ": expected " + expected);
}

std::string help_hint(const std::string& command) {
  return "; see 'raycone " + (command.empty() ? "" : command + " ") + "--help'";
}

// ---- Values ----------------------------------------------------------------------------------------------------

// The values of one command's options, of each the last one given.
class Values {
 public:
  explicit Values(const CLI::App& app) : app_(app) {}

  [[nodiscard]] bool given(const std::string& name) const { return app_.count(name) > 0; }
  [[nodiscard]] std::string text(const std::string& name) const {
    return given(name) ? app_.get_option(name)->results().back() : std::string();
  }

  [[nodiscard]] double positive(const std::string& name) const {
    const std::optional<double> number = number_from(text(name));
    if (!number || !(*number > 0.0)) invalid(name, text(name), "a positive number");
    return *number;
  }

  [[nodiscard]] std::int64_t integer(const std::string& name, std::int64_t least, std::int64_t most) const {
    const std::optional<std::int64_t> number = integer_from(text(name));
    if (number && *number >= least && *number <= most) return *number;
    invalid(name, text(name), "an integer from " + std::to_string(least) + " to " + std::to_string(most));
  }

  // Throws UsageError if `name` is given together with one of `others`.
  void exclude(const std::string& name, std::initializer_list<const char*> others) const {
    if (!given(name)) return;
    for (const char* const other : others) {
      if (given(other)) throw UsageError(name + ": cannot be combined with " + other);
    }
  }

 private:
  const CLI::App& app_;
};

Weld parse_weld(const Values& values) {
  const std::string text = values.text("--weld");
  if (text.empty() || text == "exact") return {WeldMode::kExact, 0.0};
  if (text == "none") return {WeldMode::kNone, 0.0};
  const std::optional<double> distance = number_from(text);
  if (!distance || !(*distance > 0.0)) invalid("--weld", text, "exact, none or a positive distance");
  return {WeldMode::kDistance, *distance};
}

MeshOptions parse_mesh(const Values& values) {
  MeshOptions mesh;
  mesh.path = values.text("MESH");
  if (mesh.path.empty()) throw UsageError("MESH: expected a file, not an empty name");
  if (values.given("--mesh-format")) {
    mesh.reading.format = mesh_format_from_name(values.text("--mesh-format"));
    if (!mesh.reading.format) invalid("--mesh-format", values.text("--mesh-format"), "obj, ply, stl, off, gltf or glb");
  }
  if (values.given("--scale")) mesh.reading.scale = values.positive("--scale");
  mesh.reading.y_up_to_z_up = values.given("--up");
  if (values.given("--up") && values.text("--up") != "y-to-z") invalid("--up", values.text("--up"), "y-to-z");
  mesh.weld = parse_weld(values);
  return mesh;
}

RunOptions parse_run(const Values& values) {
  RunOptions run;
  if (values.given("--threads")) run.threads = static_cast<int>(values.integer("--threads", 1, kMaxThreads));
  if (values.given("--timeout")) run.timeout = values.positive("--timeout");
  if (values.given("--memory-limit")) {
    run.memory_limit = byte_count_from(values.text("--memory-limit"));
    if (!run.memory_limit) {
      invalid("--memory-limit", values.text("--memory-limit"), "bytes, with K, M, G or T behind the number if need be");
    }
  }
  if (values.given("--progress")) {
    const std::map<std::string, ProgressMode> modes{
        {"always", ProgressMode::kAlways}, {"never", ProgressMode::kNever}, {"auto", ProgressMode::kAuto}};
    const auto mode = modes.find(values.text("--progress"));
    if (mode == modes.end()) invalid("--progress", values.text("--progress"), "always, never or auto");
    run.progress = mode->second;
  }
  run.quiet = values.given("--quiet");
  run.strict = values.given("--strict");
  return run;
}

// The formats that a command writes, and the one that it will.
struct OutputFormats {
  std::vector<FieldFormat> written;
  std::string listed;  // for messages
  std::string later;
};

FieldFormat parse_format(const Values& values, const std::string& output, const OutputFormats& formats) {
  const bool named = values.given("--format");
  if (!named && output == "-") return FieldFormat::kCsv;
  const std::string extension = std::filesystem::path(output).extension().string();
  std::string name = named ? values.text("--format") : extension.substr(std::min<std::size_t>(extension.size(), 1));
  const std::optional<FieldFormat> format = field_format_from_name(name);
  if (format && std::ranges::count(formats.written, *format) > 0) return *format;
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return c < 128 ? std::tolower(c) : c; });
  if (name == formats.later) not_available(named ? "--format " + name : output);
  if (named) invalid("--format", values.text("--format"), formats.listed);
  throw UsageError(output + ": its extension names no format, expected " + formats.listed + ", or --format");
}

OutputOptions parse_output(const Values& values, const OutputFormats& formats) {
  OutputOptions output;
  output.path = values.given("--output") ? values.text("--output") : "-";
  output.format = parse_format(values, output.path, formats);
  output.no_clobber = values.given("--no-clobber");
  if (values.given("--report")) output.report = values.text("--report");
  if (output.report == output.path) throw UsageError("--report " + output.path + ": is the output too");
  return output;
}

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
  } else if (const std::optional<double> width = number_from(text)) {
    return WorldPadding{*width};
  }
  invalid("--padding", text, "a distance, or an integer number of voxels such as 3v");
}

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

// A file name may contain colons: the grid's name starts behind the last ".vdb:".
GridReference parse_like(const std::string& text) {
  const std::size_t end = text.rfind(".vdb:");
  if (end == std::string::npos) return {text, ""};
  return {text.substr(0, end + 4), text.substr(end + 5)};
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

ReadPointsOptions parse_point_columns(const Values& values) {
  if (!values.given("--columns")) return {};
  constexpr std::int64_t kMaxColumn = 1'000'000;
  const std::string text = values.text("--columns");
  const std::vector<std::int64_t> columns = integers_from(text).value_or(std::vector<std::int64_t>());
  const bool valid = std::ranges::all_of(columns, [](std::int64_t n) { return n >= 1 && n <= kMaxColumn; });
  if (!valid || columns.size() != 3) invalid("--columns", text, "three column numbers such as 2,3,4");
  return {{{static_cast<int>(columns[0]), static_cast<int>(columns[1]), static_cast<int>(columns[2])}}};
}

// ---- Commands --------------------------------------------------------------------------------------------------

LatticeCommand parse_lattice(const Values& values) {
  if (!values.given("--output")) throw UsageError("no output given, expected -o OUT" + help_hint("lattice"));
  LatticeCommand command;
  command.field = parse_field(values);
  command.mesh = parse_mesh(values);
  command.run = parse_run(values);
  command.lattice = parse_lattice_request(values);
  command.output =
      parse_output(values, {{FieldFormat::kVdb, FieldFormat::kCsv, FieldFormat::kNpy}, "vdb, csv or npy", "vti"});
  command.output.double_precision = values.given("--double");
  if (command.field.diagnostics && command.output.format == FieldFormat::kNpy) {
    throw UsageError("--diagnostics: npy holds one number per sample, expected vdb or csv");
  }
  return command;
}

PointsCommand parse_points(const Values& values) {
  PointsCommand command;
  command.field = parse_field(values);
  command.mesh = parse_mesh(values);
  command.run = parse_run(values);
  command.output = parse_output(values, {{FieldFormat::kCsv, FieldFormat::kNpy}, "csv or npy", "npz"});
  command.points = values.text("POINTS");
  if (command.points.empty()) throw UsageError("POINTS: expected a file, not an empty name");
  if (command.mesh.path == "-" && command.points == "-") {
    throw UsageError("MESH and POINTS cannot both be standard input");
  }
  command.reading = parse_point_columns(values);
  return command;
}

InfoCommand parse_info(const Values& values) { return {parse_mesh(values), parse_run(values), values.given("--json")}; }

std::string version_text() { return std::string("raycone ") + kVersion + " (" + kCommit + ")\n" + kLibraries + "\n"; }

// ---- CLI11 -----------------------------------------------------------------------------------------------------

// Option names of all commands; each takes a value in every command that has it, or in none.
OptionNames all_option_names(const CLI::App& root) {
  OptionNames names;
  std::vector<const CLI::App*> apps = root.get_subcommands({});
  apps.push_back(&root);
  for (const CLI::App* const app : apps) {
    for (const CLI::Option* const option : app->get_options()) {
      std::set<std::string>& group = option->get_items_expected_max() > 0 ? names.with_value : names.flags;
      for (const std::string& name : option->get_lnames()) group.insert("--" + name);
      for (const std::string& name : option->get_snames()) group.insert("-" + name);
    }
  }
  return names;
}

// CLI11's formatter leaves two blank lines between groups and none below the description.
std::string help_text(const CLI::App& app, const std::string& program) {
  std::string text = app.help(program);
  for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n")) text.erase(at, 1);
  return text.insert(text.find("\nUsage:"), 1, '\n');
}

bool contains(const OptionNames& names, const OptionArgument& option) {
  return names.with_value.contains(option.name) || names.flags.contains(option.name);
}

bool given(const Arguments& arguments, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(arguments.options,
                             [&](const OptionArgument& option) { return std::ranges::count(names, option.name) > 0; });
}

const CLI::App& command_named(const CLI::App& root, const std::string& name) {
  if (kLaterCommands.contains(name)) not_available(name);
  const std::vector<const CLI::App*> commands = root.get_subcommands({});
  const auto found = std::ranges::find(commands, name, &CLI::App::get_name);
  if (!name.empty() && found != commands.end()) return **found;
  const std::string what = name.empty() ? "no command given" : "unknown command " + name;
  throw UsageError(what + ", expected lattice, points or info" + help_hint(""));
}

// CLI11 would ask for missing operands before it names a wrong option.
void check_options(const CLI::App& command, const Arguments& arguments) {
  for (const OptionArgument& option : arguments.options) {
    if (!command.get_option_no_throw(option.name)) {
      throw UsageError("unknown option " + option.name + help_hint(command.get_name()));
    }
    for (const OptionNames* const later : {&kLaterFieldOptions, &kLaterLatticeOptions, &kLaterPointsOptions}) {
      if (contains(*later, option)) not_available(option.name);
    }
  }
}

// `arguments` in a form that CLI11 cannot take for anything else.
std::vector<std::string> unmistakable(const Arguments& arguments) {
  std::vector<std::string> result{arguments.command};
  for (const OptionArgument& option : arguments.options) {
    const bool joined_by_equals = option.name.starts_with("--") && !option.value.empty();
    result.push_back(option.name + (joined_by_equals ? "=" : "") + option.value);
  }
  result.push_back("--");
  result.insert(result.end(), arguments.operands.begin(), arguments.operands.end());
  return result;
}

// CLI11 would list its own end-of-options mark among them.
void check_operand_count(const CLI::App& command, const Arguments& arguments) {
  const std::size_t expected =
      command.get_options([](const CLI::Option* option) { return option->get_positional(); }).size();
  if (arguments.operands.size() <= expected) return;
  throw UsageError("unexpected operand " + arguments.operands[expected] + help_hint(arguments.command));
}

void parse_with_cli11(CLI::App& root, const Arguments& arguments) {
  std::vector<std::string> reversed = unmistakable(arguments);
  std::ranges::reverse(reversed);
  try {
    root.parse(reversed);
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + help_hint(arguments.command));
  }
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& words) {
  CLI::App root("Exact winding numbers of triangle meshes", "raycone");
  declare_commands(root);
  const Arguments arguments = split_arguments(words, all_option_names(root));
  if (given(arguments, {"--version"})) return PrintCommand{version_text()};
  const bool help = given(arguments, {"-h", "--help"});
  if (help && arguments.command.empty()) return PrintCommand{help_text(root, "")};
  if (arguments.command.empty()) check_options(root, arguments);
  const CLI::App& command = command_named(root, arguments.command);
  if (help) return PrintCommand{help_text(command, "raycone")};
  check_options(command, arguments);
  check_operand_count(command, arguments);
  parse_with_cli11(root, arguments);
  const Values values(command);
  if (command.get_name() == "lattice") return parse_lattice(values);
  if (command.get_name() == "points") return parse_points(values);
  return parse_info(values);
}

}  // namespace raycone
