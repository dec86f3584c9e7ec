// Ticks of axes, and pictures with axes and legend around them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/picture/colour_map.h"
#include "app/picture/contours.h"
#include "app/picture/framed_picture.h"
#include "app/picture/slice_picture.h"
#include "app/picture/ticks.h"

namespace raycone::test {
namespace {

std::vector<std::string> texts(const Ticks& ticks) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks.marks) result.push_back(tick.text);
  return result;
}

Ticks at_most(std::size_t count, double from, double to) {
  return round_ticks(from, to, [&](const Ticks& ticks) { return ticks.marks.size() <= count; });
}

using Words = std::vector<std::string>;

TEST(RoundTicks, AreRoundNumbersWithinTheRange) {
  EXPECT_EQ(texts(at_most(7, -0.5, 1.5)), (Words{"-0.5", "0", "0.5", "1", "1.5"}));
  EXPECT_EQ(texts(at_most(7, 1.5, -0.5)), (Words{"-0.5", "0", "0.5", "1", "1.5"}));
  EXPECT_EQ(texts(at_most(6, 0.0, 1e-9)), (Words{"0", "2e-10", "4e-10", "6e-10", "8e-10", "1e-9"}));
  EXPECT_EQ(texts(at_most(4, -1e9, 2e9)), (Words{"-1e9", "0", "1e9", "2e9"}));
  EXPECT_EQ(texts(at_most(4, 10.0, 43.0)), (Words{"10", "20", "30", "40"}));
}

TEST(RoundTicks, FarFromZeroCountFromAnOffset) {
  const Ticks ticks = at_most(3, 1e9 - 1.0, 1e9 + 1.0);
  EXPECT_EQ(ticks.offset, " - 1e9");
  EXPECT_EQ(texts(ticks), (Words{"-1", "0", "1"}));
  EXPECT_EQ(ticks.marks.front().value, 1e9 - 1.0);
  EXPECT_EQ(at_most(3, -123456789.0, -123456787.0).offset, " + 123457000");
  EXPECT_EQ(at_most(5, 0.0, 1e7).offset, "");
}

TEST(RoundTicks, AreOneWhereNoTwoFitAndNoneWhereDoubleHasNoRoom) {
  EXPECT_EQ(at_most(0, 0.0, 10.0).marks.size(), 1U);
  EXPECT_TRUE(at_most(9, 3.0, 3.0).marks.empty());
  EXPECT_TRUE(at_most(9, -1.7e308, 1.7e308).marks.empty());   // the range overflows
  EXPECT_LE(at_most(9, 1e17, 1e17 + 64.0).marks.size(), 1U);  // neighbours would be rounded
  EXPECT_FALSE(at_most(9, 0.0, 1e308).marks.empty());
  EXPECT_FALSE(at_most(9, 0.0, 5e-324 * 1000).marks.empty());
}

PlaneView view_of(std::int64_t width, std::int64_t height) {
  PlaneView view;
  view.right = {1.0, 0.0, 0.0};
  view.up = {0.0, 1.0, 0.0};
  view.normal = {0.0, 0.0, 1.0};
  view.width = width;
  view.height = height;
  return view;
}

// Twice that is no number any more.
TEST(ColourMap, ReachesAsFarAsDistancesDo) {
  const ColourMap colours({.centre = 0.0, .half_width = 1.7e308, .inside_below = true});
  EXPECT_EQ(colours(-1.7e308), ColourMap({.centre = 0.0, .inside_below = true})(-1.0));
  EXPECT_EQ(colours(0.0), ColourMap({.centre = 0.0})(0.0));
  EXPECT_EQ(colours(1.7e308), ColourMap({.centre = 0.0})(-1.0)) << "inside is below";
}

Image picture_of(const PlaneView& view, PictureFrame frame) {
  const std::vector<double> values(static_cast<std::size_t>(view.width * view.height), 1.0);
  return slice_picture(view, {PictureField::kWinding, values}, {}, frame);
}

TEST(FramedPicture, IsAsLongAsThePlainOne) {
  for (const auto& [width, height] : std::vector<std::pair<std::int64_t, std::int64_t>>{
           {320, 320}, {800, 321}, {333, 1200}, {1000, 1}, {1, 1000}, {2000, 2000}}) {
    const PlaneView view = view_of(width, height);
    const Image page = picture_of(view, PictureFrame::kAxesAndLegend);
    EXPECT_EQ(std::max(page.width(), page.height()), std::max(width, height)) << width << " x " << height;
    const Image plain = picture_of(view, PictureFrame::kNone);
    EXPECT_EQ(plain.width(), width);
    EXPECT_EQ(plain.height(), height);
    const double page_bytes = static_cast<double>(page.pixels().size_bytes());
    EXPECT_LE(page_bytes, framed_picture_bytes(view));
  }
}

TEST(FramedPicture, OfTheLargestDistancesHasALegend) {
  PlaneView view = view_of(400, 400);
  std::vector<double> values(400 * 400);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = (n % 400 < 200 ? -1.0 : 1.0) * 1.7e308;
  const Image page = slice_picture(view, {PictureField::kDistance, values}, {}, PictureFrame::kAxesAndLegend);
  EXPECT_EQ(page.width(), 400);
}

TEST(FramedPicture, IsThePlainOneWhereThereIsNoRoom) {
  const Image page = picture_of(view_of(kLeastFramedSize - 1, 200), PictureFrame::kAxesAndLegend);
  EXPECT_EQ(page.width(), kLeastFramedSize - 1);
  EXPECT_EQ(page.height(), 200);
}

// The legend and the numbers lie beside the plot, never on it.
TEST(FramedPicture, HasTheWholePlotInOneColour) {
  const PlaneView view = view_of(640, 640);
  const Rgb colour = picture_of(view, PictureFrame::kNone).at(0, 0);
  const Image page = picture_of(view, PictureFrame::kAxesAndLegend);
  std::int64_t left = page.width(), right = -1, top = page.height(), bottom = -1, count = 0;
  for (std::int64_t row = 0; row < page.height(); ++row) {
    for (std::int64_t column = 0; column < page.width() * 4 / 5; ++column) {  // the legend's bar has the colour, too
      if (page.at(column, row) != colour) continue;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
      ++count;
    }
  }
  EXPECT_EQ(count, (right - left + 1) * (bottom - top + 1));
  EXPECT_GT(bottom - top, 500);  // of 640; the axis below takes the rest
}

// Above the plot; nothing else changes.
TEST(FramedPicture, HasTheFirstTitleThatThereIsRoomFor) {
  const PlaneView view = view_of(640, 480);
  const std::vector<double> values(640 * 480, 0.25);
  const auto with = [&](const std::vector<std::string>& titles) {
    return slice_picture(view, {PictureField::kWinding, values, {}, titles}, {}, PictureFrame::kAxesAndLegend);
  };
  const Image plain = with({}), titled = with({"teapot.obj, y = 0"});
  ASSERT_EQ(titled.width(), plain.width());
  ASSERT_EQ(titled.height(), plain.height());
  std::int64_t changed = 0, lowest = 0, rightmost = 0;
  for (std::int64_t row = 0; row < plain.height(); ++row) {
    for (std::int64_t column = 0; column < plain.width(); ++column) {
      if (titled.at(column, row) == plain.at(column, row)) continue;
      ++changed;
      lowest = std::max(lowest, row);
      rightmost = std::max(rightmost, column);
    }
  }
  EXPECT_GT(changed, 100);
  EXPECT_LT(static_cast<double>(lowest), 2.4 * text_height(view));
  EXPECT_LT(rightmost, 400);
  const auto same = [](const Image& a, const Image& b) { return std::ranges::equal(a.pixels(), b.pixels()); };
  EXPECT_TRUE(same(with({std::string(100, 'm'), "teapot.obj, y = 0", "y = 0"}), titled));
  EXPECT_TRUE(same(with({std::string(100, 'm')}), plain));
}

TEST(ShrunkImage, HasTheMeanOfWhatPixelsCover) {
  Image image(3, 1);
  image.at(0, 0) = {255, 0, 90};
  image.at(1, 0) = {0, 0, 90};
  image.at(2, 0) = {0, 30, 90};
  const Image two = shrunk(image, 2, 1);
  EXPECT_EQ(two.at(0, 0), (Rgb{170, 0, 90}));
  EXPECT_EQ(two.at(1, 0), (Rgb{0, 20, 90}));
  const Image one = shrunk(image, 1, 1);
  EXPECT_EQ(one.at(0, 0), (Rgb{85, 10, 90}));
}

TEST(SlicePicture, OfDistancesIsRedInsideAndBlueOutside) {
  const PlaneView view = view_of(2, 1);
  const std::vector<double> values{-1.0, 1.0};
  const Image image = slice_picture(view, {PictureField::kDistance, values}, {}, PictureFrame::kNone);
  EXPECT_GT(image.at(0, 0).red, image.at(0, 0).blue);
  EXPECT_LT(image.at(1, 0).red, image.at(1, 0).blue);
}

// Of the pixels of a picture of values that rise evenly from one end to the other, whether any is darker than its
// colour.
bool has_contours(double least, double most) {
  const PlaneView view = view_of(200, 4);
  std::vector<double> values(static_cast<std::size_t>(view.width * view.height));
  for (std::size_t n = 0; n < values.size(); ++n) {
    values[n] = least + (most - least) * static_cast<double>(n % 200) / 199.0;
  }
  const Image image = slice_picture(view, {PictureField::kWinding, values}, {}, PictureFrame::kNone);
  const ColourMap colours(colour_range(values));
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (image.pixels()[n] != colours(values[n])) return true;
  }
  return false;
}

TEST(SlicePicture, HasNoContoursWhereTheyWouldHideTheColours) {
  EXPECT_TRUE(has_contours(-5.9, 6.9));
  EXPECT_FALSE(has_contours(-8.9, 9.9));
  EXPECT_FALSE(has_contours(-1e12, 1e12)) << "and ends";
}

// Where nearly all values are within a range of few levels.
TEST(TraceContours, LeaveOutSquaresThatTheyWouldFill) {
  const std::vector<double> values{0.0, 1.0, 1.0, 1e12, 0.0, 1.0, 1.0, 1e12};
  int lines = 0;
  trace_contours(values, 4, 2, Raster<std::uint8_t>(3, 1), Levels{}, [&](const PictureSegment&) { ++lines; });
  EXPECT_EQ(lines, 1);
}

// Hundreds of parts with long names, in pictures of all sizes: what does not fit is left out. (Pixels outside of an
// image are memory of something else, which sanitizers notice.)
TEST(SlicePicture, OfLabelsHasALegendThatFits) {
  const std::vector<std::string> names(500, "WWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWWW \xc3\xa9 mmmmmm");
  for (const auto& [width, height] : std::vector<std::pair<std::int64_t, std::int64_t>>{
           {320, 320}, {320, 10}, {10, 320}, {400, 700}, {1024, 1024}, {4096, 16}}) {
    const PlaneView view = view_of(width, height);
    std::vector<double> values(static_cast<std::size_t>(width * height));
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(n % 501);
    const Image page = slice_picture(view, {PictureField::kLabel, values, names}, {}, PictureFrame::kAxesAndLegend);
    EXPECT_EQ(std::max(page.width(), page.height()), std::max(width, height));
    const Image few = slice_picture(view, {PictureField::kLabel, std::vector<double>(values.size(), 7.0), names}, {},
                                    PictureFrame::kAxesAndLegend);
    EXPECT_LE(std::max(few.width(), few.height()), std::max(width, height));
  }
}

}  // namespace
}  // namespace raycone::test
