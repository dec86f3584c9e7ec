#include "app/text/csv.h"

#include <gtest/gtest.h>

namespace raycone::test {
namespace {

TEST(Csv, QuotesWhatMustBeQuoted) {
  EXPECT_EQ(csv_line({"a", "", "b c"}), "a,,b c\n");
  EXPECT_EQ(csv_line({"a,b", "say \"x\"", "two\nlines", "\r"}), "\"a,b\",\"say \"\"x\"\"\",\"two\nlines\",\"\r\"\n");
  EXPECT_EQ(csv_line({"", "x"}), ",x\n");
}

TEST(Csv, ReadsWhatItWrites) {
  const std::vector<CsvRecord> records{
      {"a", "", "b c"}, {"", ""}, {"a,b", "\"", "\n", "\r\n"}, {"\xC3\xA4\xFF", "\"\""}};
  std::string text;
  for (const CsvRecord& record : records) text += csv_line(record);
  const CsvText read = parse_csv(text);
  EXPECT_EQ(read.records, records);
  EXPECT_EQ(read.complete, text.size());
}

TEST(Csv, LeavesOutALineThatIsNotComplete) {
  const std::string first = csv_line({"a", "b"});
  const std::string second = csv_line({"c,\n", "\"d\""});
  for (std::size_t size = 0; size < second.size(); ++size) {
    const CsvText read = parse_csv(first + second.substr(0, size));
    EXPECT_EQ(read.records, (std::vector<CsvRecord>{{"a", "b"}})) << size;
    EXPECT_EQ(read.complete, first.size());
  }
}

TEST(Csv, AcceptsTheLineEndsOfOtherPrograms) {
  EXPECT_EQ(parse_csv("a,b\r\nc,\"d\r\n\"\r\n").records, (std::vector<CsvRecord>{{"a", "b"}, {"c", "d\r\n"}}));
}

}  // namespace
}  // namespace raycone::test
