// raycone batch: the options of raycone lattice and --sample, but for those about one file, and its own.
#include "app/command_line/batch_options.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "app/command_line/common_options.h"
#include "app/command_line/given_options.h"
#include "app/command_line/idle_options.h"
#include "app/command_line/lattice_options.h"
#include "app/command_line/parse_shard.h"
#include "app/command_line/points_options.h"
#include "app/command_line/sample_options.h"
#include "app/process/usage_error.h"
#include "io/files/ascii.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

// Options of lattices that batches understand in their own way, or not at all.
const std::set<std::string> kOfOneFile{"--output", "--report", "--depfile"};
const std::set<std::string> kOfSamples{"--sample", "--seed"};  // and lattices have none of these
const std::set<std::string> kOfBatches{"--format", "--threads", "--memory-limit", "--timeout", "--progress", "--quiet"};

// `formats`: those of lattices.
OptionGroup batch_group(const std::string& formats) {
  return {"Batch",
          {{"--out-dir", "DIR", "Directory for the outputs and results.csv"},
           {"--format", formats + "|none", "Format of outputs (default: vdb; npz of samples); none: results.csv only"},
           {"--full-names", "", "Keep the mesh's extension in the output's name: a.stl.vdb"},
           {"-0,--null", "", "Paths in lists end with NUL, not with a line feed"},
           {"--jobs", "J", "Number of meshes at a time, each on one thread at least (default: as --threads allows)"},
           {"--shard", "I/N|slurm", "Do only part I of N; slurm: the part of this array task"},
           {"--retry-failed", "", "Try failed meshes again"},
           {"--keep-going", "", "Go on when a mesh fails (default)"},
           {"--fail-fast", "", "Stop when a mesh fails"},
           {"--exit-zero", "", "Exit with status 0 although meshes failed; results.csv has them"},
           {"--prune", "", "Remove the rows of meshes that are gone"},
           {"--dry-run", "", "List what would be done and why, and do nothing"}}};
}

OptionGroup batch_run_group() {
  OptionGroup group = run_group();
  for (OptionSpec& option : group.options) {
    if (option.names == "--threads")
      option.description = "Number of threads, all meshes together (default: RAYCONE_THREADS, else the CPUs)";
    if (option.names == "--memory-limit") option.description = "Memory per mesh (default: an equal share)";
    if (option.names == "--timeout") option.description = "Give up on a mesh after S seconds (default: 3600)";
  }
  return group;
}

OptionGroup batch_sample_group() {
  OptionGroup group = sample_group();
  std::erase_if(group.options, [](const OptionSpec& option) { return !kOfSamples.contains(option.names); });
  return group;
}

// The options that are handed on as they are.
bool is_handed_on(const std::string& name) {
  static const OptionNames lattice = option_names(lattice_spec());
  if (kOfOneFile.contains(name) || kOfBatches.contains(name)) return false;
  return contains(lattice, name) || kOfSamples.contains(name);
}

// Of the options of one mesh, by their long names. Throws UsageError for those that belong to the other one of lattices
// and samples.
using MeshValues = std::map<std::string, std::vector<std::string>>;
MeshValues mesh_values_in(const Values& values) {
  const bool sampled = values.given("--sample");
  const OptionNames known = option_names(sampled ? points_spec() : lattice_spec());
  MeshValues of_mesh;
  for (const auto& [name, given] : values.all()) {
    if (!is_handed_on(name)) continue;
    if (!contains(known, name)) {
      if (sampled) throw UsageError("--sample: cannot be combined with " + name);
      invalid(name, given.back(), "--sample with it");
    }
    of_mesh.emplace(name, given);
  }
  return of_mesh;
}

// How outputs are written if nothing else is said.
std::string default_format(bool sampled) { return sampled ? "npz" : "vdb"; }

// The name of a format in lower case, "none" included.
std::string parse_batch_format(const Values& values) {
  std::string format =
      lower_case(values.given("--format") ? values.text("--format") : default_format(values.given("--sample")));
  if (format != "none" && !field_format_from_name(format)) {
    std::vector<std::string> expected = names_of(formats_that_hold(FormatTraits::kLattices));
    expected.emplace_back("none");
    invalid("--format", values.text("--format"), enumerated(expected, " or "));
  }
  return format;
}

// What is done to one mesh, whose files and limits are yet to be filled in: a lattice, or the points that are drawn.
MeshCommand parse_for_each(const std::string& format, MeshValues of_mesh) {
  const bool sampled = of_mesh.contains("--sample");
  // What writes nothing accepts what any format does.
  const bool writes = format != "none";
  of_mesh["--format"] = {writes ? format : default_format(sampled)};
  of_mesh["--output"] = {"-"};
  of_mesh["--progress"] = {"never"};
  of_mesh["--quiet"] = {"true"};
  of_mesh["MESH"] = {"MESH"};
  const Values values(std::move(of_mesh));
  const auto finish = [writes](auto command) -> MeshCommand {
    if (!writes) command.encoding.format = FieldFormat::kNone;
    return command;
  };
  const Command command = sampled ? parse_points(values) : parse_lattice(values);
  return sampled ? finish(std::get<PointsCommand>(command)) : finish(std::get<LatticeCommand>(command));
}

// Each mesh of a batch is evaluated alone.
void refuse_parts_by_file(const MeshOptions& mesh, const FieldOptions& field) {
  if (!field.has(Field::kLabel) || mesh.parts.by != PartsBy::kFile) return;
  throw UsageError("--field label: a batch evaluates each mesh alone, expected --parts group or component");
}

bool is_list(const std::string& operand) { return operand.starts_with('@') || operand == "-"; }

// A line an option, as it was given: "--name=value", flags "--name"; none that holds anyway. Batches keep this text: to
// change how an option is written there makes all results out of date.
std::string result_options(const std::string& format, const MeshValues& of_mesh) {
  static const OptionNames known = option_names(batch_spec());
  const std::set<std::string> without_effect{"--no-clobber", "--engine", "--simd"};
  const OwnDefaults& own = of_mesh.contains("--sample") ? kDefaultsOfDrawnPoints : kDefaultsOfLattices;
  std::string text = "--format=" + format;
  for (const auto& [name, given] : of_mesh) {
    if (without_effect.contains(name)) continue;
    // Of the grid batches keep the hash.
    const std::string value = name == "--like" ? like_without_directory(given.back()) : given.back();
    const std::string option = known.flags.contains(name) ? name : name + '=' + value;
    if (!is_default(option, own)) text += '\n' + option;
  }
  return text;
}

}  // namespace

CommandSpec batch_spec() {
  CommandSpec spec = lattice_spec();
  spec.name = "batch";
  spec.description = "Evaluate many meshes, apart from each other; resumable";
  spec.operands = {{"MESH|DIR|@LIST", "Mesh, directory to search, or list of them; @- for a list on standard input",
                    OperandCount::kMany}};
  std::string formats;
  for (OptionGroup& group : spec.groups) {
    if (group.heading == "Run") group = batch_run_group();
    std::erase_if(group.options, [&formats](const OptionSpec& option) {
      const std::string name = names_of(option).back();
      if (name == "--format") formats = option.value;
      return kOfOneFile.contains(name) || name == "--format";
    });
  }
  spec.groups.insert(spec.groups.begin(), batch_group(formats));
  const auto field = std::ranges::find(spec.groups, "Field", &OptionGroup::heading);
  spec.groups.insert(field, batch_sample_group());
  spec.examples = {"raycone batch meshes --out-dir fields --resolution 128",
                   "raycone batch meshes --out-dir fields --resolution 128    again: what is missing or out of date",
                   "raycone batch meshes --out-dir measured --format none --resolution 50,50,50",
                   "raycone batch meshes --out-dir samples --sample uniform=100000,near=100000:0.01",
                   "find . -name '*.stl' -size -10M -print0 | raycone batch @- -0 --out-dir fields",
                   "raycone report fields"};
  return spec;
}

Command parse_batch(const Values& values) {
  if (!values.given("--out-dir")) throw UsageError("no directory given, expected --out-dir DIR" + help_hint("batch"));
  values.exclude("--fail-fast", {"--keep-going", "--exit-zero"});
  BatchCommand command;
  const std::string format = parse_batch_format(values);
  const MeshValues of_mesh = mesh_values_in(values);
  command.writes = format != "none";
  if (!command.writes) refuse_options_of_outputs(values);
  command.for_each = parse_for_each(format, of_mesh);
  command.result_options = result_options(format, of_mesh);
  std::visit([](const auto& one) { refuse_parts_by_file(one.mesh, one.field); }, command.for_each);
  command.directory = values.text("--out-dir");
  const bool full_names = values.given("--full-names") || !command.writes;  // no outputs, no collisions
  const std::vector<std::string> operands = values.texts("MESH|DIR|@LIST");
  if (values.given("--null") && std::ranges::none_of(operands, is_list)) {
    throw UsageError("--null: has no effect without a list, expected an operand @LIST");
  }
  command.search = {operands, values.given("--null") ? PathEnd::kNul : PathEnd::kLineFeed, full_names, format};
  if (values.given("--shard")) command.shard = parse_shard(values.text("--shard"));
  command.run = parse_run(values);
  if (values.given("--jobs")) command.jobs = static_cast<int>(values.integer("--jobs", 1, kMaxJobs));
  command.retry_failed = values.given("--retry-failed");
  command.fail_fast = values.given("--fail-fast");
  command.exit_zero = values.given("--exit-zero");
  command.prune = values.given("--prune");
  command.dry_run = values.given("--dry-run");
  return command;
}

}  // namespace raycone
