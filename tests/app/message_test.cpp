#include "app/process/message.h"

#include <gtest/gtest.h>

#include <stdexcept>

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

TEST(Message, OfADamagedProcessIsRefused) {
  MessageReader huge;
  huge.add(std::string(8, '\xFF'));
  EXPECT_THROW((void)huge.next(), std::runtime_error);
  std::string frame = to_frame({"abc"});
  frame[8] = 4;  // the string's length: one more than there is
  MessageReader longer;
  longer.add(frame);
  EXPECT_THROW((void)longer.next(), std::runtime_error);
}

TEST(Message, AloneNeedsNoFrame) {
  const Message message{"", "a", std::string("\0", 1)};
  EXPECT_EQ(message_from(to_bytes(message)), message);
  EXPECT_EQ(message_from(""), Message{});
  EXPECT_THROW((void)message_from(to_bytes(message).substr(1)), std::runtime_error);
}

TEST(Message, IsTakenApartStringByString) {
  const Message message{"text", "-3", "2", "x", "y"};
  MessageStrings strings(message);
  EXPECT_EQ(strings.text(), "text");
  EXPECT_EQ(strings.number(), -3);
  EXPECT_EQ(strings.take(strings.count()).back(), "y");
  EXPECT_TRUE(strings.rest().empty());
  EXPECT_THROW((void)strings.text(), std::runtime_error);
  EXPECT_THROW((void)MessageStrings(message).number(), std::runtime_error);
}

}  // namespace
}  // namespace raycone::test
