// Every value of a command arrives at the worker as it was. With a new member app/batch/command_message.cpp does not
// compile until it is carried, too; its change belongs into the lists here.
#include "app/batch/command_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace raycone::test {
namespace {

using Change = std::function<void(LatticeCommand&)>;
using PointsChange = std::function<void(PointsCommand&)>;

// One for each member of what both commands have; each gives it a value that no default has.
template <typename Command>
std::vector<std::function<void(Command&)>> common_changes() {
  return {[](Command& c) { c.mesh.path = std::string("a \n\0b.stl", 9); },
          [](Command& c) { c.mesh.reading.format = MeshFormat::kGlb; },
          [](Command& c) { c.mesh.reading.scale = 0.1; },
          [](Command& c) { c.mesh.reading.y_up_to_z_up = true; },
          [](Command& c) { c.mesh.weld.mode = WeldMode::kDistance; },
          [](Command& c) { c.mesh.weld.distance = 1e-300; },
          [](Command& c) { c.mesh.orient = Orient::kAuto; },
          [](Command& c) {
            c.mesh.further = {"b.stl", "c.stl"};
          },
          [](Command& c) { c.mesh.lists = {"list"}; },
          [](Command& c) { c.mesh.parts.by = PartsBy::kComponent; },
          [](Command& c) { c.mesh.parts.priority = PartPriority::kFirst; },
          [](Command& c) { c.run.threads = 3; },
          [](Command& c) { c.run.memory_limit = 1'000'000'000'000; },
          [](Command& c) { c.run.timeout = 0.5; },
          [](Command& c) { c.run.progress = ProgressMode::kNever; },
          [](Command& c) { c.run.quiet = true; },
          [](Command& c) { c.run.strict = true; },
          [](Command& c) {
            c.field.fields = {Field::kDistance, Field::kInside};
          },
          [](Command& c) { c.field.fields = {}; },
          [](Command& c) { c.field.rule.kind = RuleKind::kOdd; },
          [](Command& c) { c.field.rule.threshold = -0.0; },
          [](Command& c) { c.field.band = 0.3; },
          [](Command& c) { c.field.diagnostics = true; },
          [](Command& c) { c.field.verify = UINT64_MAX; },
          [](Command& c) { c.field.engine = RayEngine::kEmbree; },
          [](Command& c) { c.field.simd = SimdLevel::kAvx2; },
          [](Command& c) { c.output.path = "o.vdb"; },
          [](Command& c) { c.output.existing = Existing::kKept; },
          [](Command& c) { c.output.report = ""; },
          [](Command& c) { c.output.depfile = "o.d"; },
          [](Command& c) { c.encoding.format = FieldFormat::kNone; },
          [](Command& c) { c.encoding.precision = Precision::kDouble; },
          [](Command& c) { c.encoding.precision = Precision::kHalf; },
          [](Command& c) { c.encoding.pack_bits = true; },
          [](Command& c) { c.encoding.compress = true; },
          [](Command& c) {
            c.run.options = {"--a=b", "--c"};
          },
          [](Command& c) {
            c.run.words = {"a", ""};
          },
          [](Command& c) {
            c.mesh.normalize = {NormalizeTo::kCube, 2.0};
          },
          [](Command& c) {
            c.mesh.normalize = {NormalizeTo::kSphere, 1.0};
          },
          [](Command& c) { c.encoding.grid_name = "density"; }};
}

LatticeRequest& request_of(LatticeCommand& command) { return std::get<LatticeRequest>(command.lattice); }

std::vector<Change> lattice_changes() {
  std::vector<Change> changes = common_changes<LatticeCommand>();
  const std::vector<Change> own{[](LatticeCommand& c) {
                                  request_of(c).bounds = Box{{1, 2, 3}, {4, 5, 6}};
                                },
                                [](LatticeCommand& c) { request_of(c).padding = WorldPadding{-1.5}; },
                                [](LatticeCommand& c) {
                                  request_of(c).padding = WorldPadding{-1.5, true};
                                },
                                [](LatticeCommand& c) { request_of(c).padding = VoxelPadding{-3}; },
                                [](LatticeCommand& c) { request_of(c).sampling = LongestSide{5}; },
                                [](LatticeCommand& c) {
                                  request_of(c).sampling = SampleCounts{{1, 2, std::int64_t{1} << 53}};
                                },
                                [](LatticeCommand& c) {
                                  request_of(c).sampling = VoxelSize{{0.1, 0.2, 0.3}};
                                },
                                [](LatticeCommand& c) { request_of(c).centers = true; },
                                [](LatticeCommand& c) {
                                  c.lattice = GridReference{"a.vdb", ""};
                                },
                                [](LatticeCommand& c) {
                                  c.lattice = GridReference{"a.vdb", "b"};
                                }};
  changes.insert(changes.end(), own.begin(), own.end());
  return changes;
}

std::vector<PointsChange> points_changes() {
  std::vector<PointsChange> changes = common_changes<PointsCommand>();
  const std::vector<PointsChange> own{[](PointsCommand& c) { c.points = "p.csv"; },
                                      [](PointsCommand& c) {
                                        c.reading.columns = {2, 3, 4};
                                      },
                                      [](PointsCommand& c) { c.reading.raw = RawPrecision::kSingle; },
                                      [](PointsCommand& c) { c.sample.emplace(); },
                                      [](PointsCommand& c) {
                                        c.sample.emplace().groups = {UniformSamples{7}, NearSamples{8, 0.01}};
                                      },
                                      [](PointsCommand& c) {
                                        c.sample.emplace().groups = {UniformSamples{7}, NearSamples{8, 0.02}};
                                      },
                                      [](PointsCommand& c) { c.sample.emplace().groups = {SurfaceSamples{7}}; },
                                      [](PointsCommand& c) { c.sample.emplace().seed = 2; },
                                      [](PointsCommand& c) {
                                        c.sample.emplace().bounds = Box{{1, 2, 3}, {4, 5, 6}};
                                      },
                                      [](PointsCommand& c) { c.sample.emplace().padding = WorldPadding{0.5}; }};
  changes.insert(changes.end(), own.begin(), own.end());
  return changes;
}

// Each change alone must make another message than every other one, and one that says the same when it has arrived.
template <typename Command>
void expect_all_to_arrive(const std::vector<std::function<void(Command&)>>& changes) {
  std::vector<Message> messages{to_message(Command())};
  for (const auto& change : changes) {
    Command command;
    change(command);
    messages.push_back(to_message(command));
  }
  for (std::size_t n = 0; n < messages.size(); ++n) {
    EXPECT_EQ(std::ranges::count(messages, messages[n]), 1) << "change " << n << " is not carried";
    EXPECT_EQ(to_message(mesh_command_from(messages[n])), messages[n]) << "change " << n;
  }
  Command all;
  for (const auto& change : changes) change(all);
  EXPECT_EQ(to_message(mesh_command_from(to_message(all))), to_message(all));
}

TEST(CommandMessage, CarriesEveryMemberOfLattices) { expect_all_to_arrive(lattice_changes()); }

TEST(CommandMessage, CarriesEveryMemberOfPoints) { expect_all_to_arrive(points_changes()); }

TEST(CommandMessage, GivesWhatWasSent) {
  LatticeCommand sent;
  sent.mesh.path = "a.stl";
  sent.run.threads = 3;
  sent.field.fields = {Field::kDistance};
  sent.encoding.format = FieldFormat::kVdb;
  sent.lattice = GridReference{"g.vdb", "name"};
  const auto received = std::get<LatticeCommand>(mesh_command_from(to_message(sent)));
  EXPECT_EQ(received.mesh.path, "a.stl");
  EXPECT_EQ(received.run.threads, 3);
  EXPECT_EQ(received.run.memory_limit, std::nullopt);
  EXPECT_EQ(received.field.fields, (std::vector<Field>{Field::kDistance}));
  EXPECT_EQ(received.encoding.format, FieldFormat::kVdb);
  EXPECT_EQ(std::get<GridReference>(received.lattice).name, "name");
}

TEST(CommandMessage, ARequestForHashesIsNoCommand) {
  LatticeCommand command;
  command.mesh.path = "a.stl";
  Message message = to_message(InputsRequest{command, {1, -2, 3, 5}, 4});
  const std::optional<InputsRequest> received = inputs_request_from(message);
  ASSERT_TRUE(received);
  EXPECT_EQ(std::get<LatticeCommand>(received->command).mesh.path, "a.stl");
  EXPECT_EQ(received->stamp, (FileStamp{1, -2, 3, 5}));
  EXPECT_EQ(received->started, 4);
  EXPECT_THROW((void)mesh_command_from(message), std::runtime_error);
  EXPECT_FALSE(inputs_request_from(to_message(command)));
  message[2] = "x";
  EXPECT_FALSE(inputs_request_from(message));
}

TEST(CommandMessage, OfADamagedSupervisorIsRefused) {
  const Message message = to_message(LatticeCommand());
  EXPECT_THROW((void)mesh_command_from({}), std::runtime_error);
  EXPECT_THROW((void)mesh_command_from({message[0], message[0]}), std::runtime_error);
  EXPECT_THROW((void)mesh_command_from({message[0] + "x"}), std::runtime_error);
  for (std::size_t size = 0; size < message[0].size(); ++size) {
    EXPECT_THROW((void)mesh_command_from({message[0].substr(0, size)}), std::runtime_error) << size;
  }
  Message unknown = message;
  unknown[0][0] = 2;  // the first of the two commands is number 0
  EXPECT_THROW((void)mesh_command_from(unknown), std::runtime_error);
}

}  // namespace
}  // namespace raycone::test
