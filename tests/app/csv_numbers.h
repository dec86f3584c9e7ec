// CSV of numbers, as tests of the command line read it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace raycone::test {

struct CsvNumbers {
  std::vector<std::string> names;  // of the columns
  std::vector<std::vector<double>> rows;

  [[nodiscard]] std::vector<double> column(const std::string& name) const {
    const auto place = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    std::vector<double> numbers;
    for (const std::vector<double>& row : rows) numbers.push_back(row.at(place));
    return numbers;
  }
};

// Expects as many numbers in each row as there are names.
inline CsvNumbers csv_numbers(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, cell;
  std::getline(lines, line);
  CsvNumbers result;
  for (std::istringstream head(line); std::getline(head, cell, ',');) result.names.push_back(cell);
  while (std::getline(lines, line)) {
    result.rows.emplace_back();
    for (std::istringstream row(line); std::getline(row, cell, ',');) result.rows.back().push_back(std::stod(cell));
    EXPECT_EQ(result.rows.back().size(), result.names.size()) << line;
  }
  return result;
}

}  // namespace raycone::test
