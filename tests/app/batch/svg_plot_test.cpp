#include "app/batch/svg_plot.h"

#include <gtest/gtest.h>

#include "app/text/html.h"

namespace raycone::test {
namespace {

TEST(HtmlText, EscapesAndRepairs) {
  EXPECT_EQ(html_text("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
  EXPECT_EQ(html_text("\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x99\x82"), "\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x99\x82");
  const std::string replaced = "\xEF\xBF\xBD";
  EXPECT_EQ(html_text("a\xFFz"), "a" + replaced + "z");
  EXPECT_EQ(html_text("\xC3"), replaced);
  EXPECT_EQ(html_text("\xED\xA0\x80").find('\xED'), std::string::npos) << "a surrogate";
  EXPECT_EQ(html_text("a\nb"), "a" + replaced + "b");
}

TEST(ReadableQuantity, HasThreeDigitsAndAUnit) {
  EXPECT_EQ(readable_quantity(0.0, Quantity::kCount), "0");
  EXPECT_EQ(readable_quantity(12.0, Quantity::kCount), "12");
  EXPECT_EQ(readable_quantity(125000.0, Quantity::kCount), "125 k");
  EXPECT_EQ(readable_quantity(0.00125, Quantity::kSeconds), "1.25 ms");
  EXPECT_EQ(readable_quantity(1e-7, Quantity::kSeconds), "100 ns");
  EXPECT_EQ(readable_quantity(3600.0, Quantity::kSeconds), "3600 s");
  EXPECT_EQ(readable_quantity(0.9997, Quantity::kSeconds), "1000 ms");
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(SvgPlot, ShowsEveryPointByName) {
  const std::string plot =
      scatter_plot({"faces"}, {"time", Quantity::kSeconds}, {{12, 0.5, "a<b"}, {0, 0.25, "closed"}, {1e6, 2, "c"}});
  EXPECT_EQ(count_of(plot, "<circle"), 3U);
  EXPECT_NE(plot.find("a&lt;b: 12, 500 ms"), std::string::npos) << plot;
  EXPECT_EQ(count_of(plot, "nan"), 0U);
  EXPECT_EQ(count_of(plot, "inf"), 0U);
}

TEST(SvgPlot, OfNothingOrOfZerosIsStillAPlot) {
  for (const std::string& plot : {scatter_plot({"x"}, {"y"}, {}), scatter_plot({"x"}, {"y"}, {{0, 0, "a"}}),
                                  histogram({"x"}, {}), histogram({"x"}, {0.0, 0.0}), histogram({"x"}, {1.0})}) {
    EXPECT_NE(plot.find("<svg"), std::string::npos);
    EXPECT_EQ(count_of(plot, "nan"), 0U) << plot;
    EXPECT_EQ(count_of(plot, "inf"), 0U) << plot;
  }
}

TEST(Histogram, CountsByQuartersOfDecades) {
  const std::string plot = histogram({"x"}, {0.0, 1.0, 1.1, 10.0, 99.0});
  EXPECT_EQ(count_of(plot, "<rect"), 4U);
  EXPECT_NE(plot.find("2 from 1 to 1.78"), std::string::npos) << plot;
  EXPECT_NE(plot.find("1 at 0"), std::string::npos) << plot;
}

}  // namespace
}  // namespace raycone::test
