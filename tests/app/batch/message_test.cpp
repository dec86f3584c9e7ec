#include "app/batch/message.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "app/batch/job_result.h"

namespace raycone::test {
namespace {

TEST(Message, ArrivesWholeHoweverItsBytesCome) {
  const std::vector<Message> messages{{"a", "", std::string("\0\n", 2)}, {}, {std::string(100000, 'x')}};
  std::string bytes;
  for (const Message& message : messages) bytes += to_frame(message);
  for (const std::size_t step : {std::size_t{1}, std::size_t{7}, bytes.size()}) {
    MessageReader reader;
    std::vector<Message> arrived;
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      reader.add(std::string_view(bytes).substr(at, step));
      while (std::optional<Message> message = reader.next()) arrived.push_back(*message);
    }
    EXPECT_EQ(arrived, messages);
  }
}

TEST(Message, OfADamagedWorkerIsRefused) {
  MessageReader huge;
  huge.add(std::string(8, '\xFF'));
  EXPECT_THROW((void)huge.next(), std::runtime_error);
  std::string frame = to_frame({"abc"});
  frame[8] = 4;  // the string's length: one more than there is
  MessageReader longer;
  longer.add(frame);
  EXPECT_THROW((void)longer.next(), std::runtime_error);
  EXPECT_THROW((void)result_from({"a"}), std::runtime_error);
}

TEST(Message, CarriesResults) {
  JobResult sent;
  sent.row.figures = MeshFigures{.faces = 12, .evaluate_s = 0.25};
  sent.row.sha256 = "0123";
  sent.row.warnings = "one two";
  sent.stamp = {1, -2, 3, 4, true};
  sent.knows_inputs = false;
  sent.buffers = {{.path = "x.bin", .sha256 = "abc"}};
  sent.grid = "def";
  sent.written = {{5, 6}, {}};
  sent.thumbnail = "iVBO";
  sent.warnings = {"one: a; b", "two: c"};
  const JobResult received = result_from(to_message(sent));
  EXPECT_EQ(received.row.figures->faces, 12U);
  EXPECT_EQ(received.row.figures->evaluate_s, 0.25);
  EXPECT_EQ(received.row.sha256, "0123");
  EXPECT_EQ(received.row.warnings, "one two");
  EXPECT_EQ(received.stamp, sent.stamp);
  EXPECT_TRUE(received.stamp.recent);
  EXPECT_FALSE(received.knows_inputs);
  EXPECT_EQ(received.buffers, sent.buffers);
  EXPECT_EQ(received.grid, "def");
  EXPECT_EQ(received.written, sent.written);
  EXPECT_EQ(received.thumbnail, "iVBO");
  EXPECT_EQ(received.warnings, sent.warnings);
}

}  // namespace
}  // namespace raycone::test
