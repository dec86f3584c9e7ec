#include "app/command_line/common_options.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>

#include "app/process/default_threads.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"
#include "io/files/ascii.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

Weld parse_weld(const Values& values) {
  const std::string text = values.text("--weld");
  if (text.empty() || text == "exact") return {WeldMode::kExact, 0.0};
  if (text == "none") return {WeldMode::kNone, 0.0};
  const std::optional<double> distance = number_from(text);
  if (!distance || !(*distance > 0.0)) invalid("--weld", text, "exact, none or a positive distance");
  return {WeldMode::kDistance, *distance};
}

Normalize parse_normalize(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string name = text.substr(0, colon);
  const std::optional<double> size = colon < text.size() ? number_from(std::string_view(text).substr(colon + 1)) : 1.0;
  const bool known = name == "cube" || name == "sphere";
  if (!known || !size || !(*size > 0.0)) invalid("--normalize", text, "cube or sphere, with :SIZE behind if need be");
  return {name == "cube" ? NormalizeTo::kCube : NormalizeTo::kSphere, *size};
}

Orient parse_orient(const Values& values) {
  if (values.text("--orient").empty()) return Orient::kKeep;
  return values.choice<Orient>("--orient", {{"keep", Orient::kKeep}, {"flip", Orient::kFlip}, {"auto", Orient::kAuto}});
}

Precision parse_dtype(const Values& values) {
  return values.choice<Precision>(
      "--dtype", {{"f16", Precision::kHalf}, {"f32", Precision::kSingle}, {"f64", Precision::kDouble}});
}

FieldFormat parse_format(const Values& values, const std::string& output, const OutputFormats& formats) {
  const bool named = values.given("--format");
  if (!named && output == "-") return formats.only.value_or(FieldFormat::kCsv);
  const std::string extension =
      has_extension(output, "nii.gz") ? ".nii.gz" : std::filesystem::path(output).extension().string();
  const std::string name =
      named ? values.text("--format") : extension.substr(std::min<std::size_t>(extension.size(), 1));
  const std::optional<FieldFormat> format = field_format_from_name(name);
  if (formats.only && format)
    throw UsageError(output + ": its extension names a format, but --raw writes bare numbers");
  if (formats.only) return *formats.only;
  if (format && std::ranges::count(formats.written, *format) > 0) return *format;
  const std::string listed = enumerated(names_of(formats.written), " or ");
  if (named) invalid("--format", values.text("--format"), listed);
  const std::string wrong = format ? name + " does not hold " + formats.contents : "its extension names no format";
  throw UsageError(output + ": " + wrong + ", expected " + listed + ", or --format");
}

}  // namespace

bool has_extension(const std::string& path, const std::string& extension) {
  return ends_with_word(path, '.' + extension);
}

OperandSpec mesh_operand() { return {"MESH", "OBJ, PLY, STL, OFF, glTF, GLB or 3MF file; - for standard input"}; }

OperandSpec meshes_operand() {
  OperandSpec operand = mesh_operand();
  operand.description += "; several, or @LIST, with --field label";
  operand.count = OperandCount::kMany;
  return operand;
}

OptionGroup mesh_group() {
  return {"Mesh",
          {{"--mesh-format", joined(mesh_format_names(), "|"),
            "Format of a mesh whose name and content do not tell it, as in pipes"},
           {"--weld", "exact|none|D", "Merge vertices at equal positions, or within D (default: exact)"},
           {"--orient", "keep|flip|auto", "Turn no face, all, or those that make the mesh agree and face outward"},
           {"--scale", "S", "Multiply all coordinates by S"},
           {"--up", "y-to-z", "Turn (x, y, z) into (x, -z, y), as Blender does to glTF and OBJ"},
           {"--normalize", "cube|sphere", "Move the mesh to the origin and scale it to size 1; cube:SIZE: to SIZE"}}};
}

MeshOptions parse_mesh(const Values& values) {
  MeshOptions mesh;
  const std::vector<std::string> paths = values.texts("MESH");
  if (paths.empty() || paths.front().empty()) throw UsageError("MESH: expected a file, not an empty name");
  mesh.path = paths.front();
  mesh.further.assign(paths.begin() + 1, paths.end());
  if (values.given("--mesh-format")) {
    mesh.reading.format = mesh_format_from_name(values.text("--mesh-format"));
    if (!mesh.reading.format) {
      invalid("--mesh-format", values.text("--mesh-format"), enumerated(mesh_format_names(), " or "));
    }
  }
  if (values.given("--scale")) mesh.reading.scale = values.positive("--scale");
  mesh.reading.y_up_to_z_up = values.given("--up");
  if (values.given("--up") && values.text("--up") != "y-to-z") invalid("--up", values.text("--up"), "y-to-z");
  if (values.given("--normalize")) mesh.normalize = parse_normalize(values.text("--normalize"));
  mesh.weld = parse_weld(values);
  mesh.orient = parse_orient(values);
  return mesh;
}

OptionGroup output_group(const std::string& formats) {
  const bool is_choice = formats.find('|') != std::string::npos;
  return {
      "Output",
      {{"-o,--output", "OUT", "File to write; - for standard output", true},
       {"--format", formats,
        is_choice ? "Format of OUT (default: by its extension, csv for -)" : "Format of OUT, whatever its extension"},
       {"--no-clobber", "", "Never replace an existing file"},
       {"--report", "FILE.json", "Write a report of the run as JSON"},
       {"--depfile", "FILE.d", "Write the files that were read as a rule for Make"}}};
}

OptionSpec pack_bits_option() { return {"--pack-bits", "", "Store inside as bits in NPZ, as numpy.packbits does"}; }

Existing parse_existing(const Values& values) {
  return values.given("--no-clobber") ? Existing::kKept : Existing::kReplaced;
}

OutputFiles parse_output_files(const Values& values) {
  OutputFiles output;
  output.path = values.given("--output") ? values.text("--output") : "-";
  output.existing = parse_existing(values);
  if (values.given("--report")) output.report = values.text("--report");
  if (values.given("--depfile")) output.depfile = values.text("--depfile");
  return output;
}

FieldEncoding parse_encoding(const Values& values, const OutputFiles& output, const OutputFormats& formats) {
  FieldEncoding encoding;
  encoding.format = parse_format(values, output.path, formats);
  if (values.given("--dtype")) encoding.precision = parse_dtype(values);
  encoding.pack_bits = values.given("--pack-bits");
  return encoding;
}

OptionGroup run_group() {
  return {"Run",
          {{"--threads", "T", "Number of threads (default: RAYCONE_THREADS, else the available CPUs)"},
           {"--memory-limit", "SIZE",
            "Refuse work that needs more memory; bytes, or K, M, G, T of 1024 (default: what is available)"},
           {"--timeout", "S", "Give up after S seconds"},
           {"--progress", "always|never|auto", "Show progress on standard error (default: auto, on a terminal)"},
           {"--quiet", "", "Print errors only"},
           {"--strict", "", "Treat warnings about the mesh as errors"},
           {"-h,--help", "", "Print this help"}}};
}

RunOptions parse_run(const Values& values) {
  RunOptions run;
  if (values.given("--threads")) run.threads = static_cast<int>(values.integer("--threads", 1, kMaxThreads));
  if (values.given("--timeout")) run.timeout = values.positive("--timeout", "seconds");
  if (values.given("--memory-limit")) {
    run.memory_limit = byte_count_from(values.text("--memory-limit"));
    if (!run.memory_limit) {
      invalid("--memory-limit", values.text("--memory-limit"), "bytes, with K, M, G or T behind the number if need be");
    }
  }
  if (values.given("--progress")) {
    run.progress = values.choice<ProgressMode>(
        "--progress",
        {{"always", ProgressMode::kAlways}, {"never", ProgressMode::kNever}, {"auto", ProgressMode::kAuto}});
  }
  run.quiet = values.given("--quiet");
  run.strict = values.given("--strict");
  return run;
}

}  // namespace raycone
