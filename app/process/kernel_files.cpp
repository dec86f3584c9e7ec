#include "app/process/kernel_files.h"

#include <fstream>
#include <sstream>

#include "app/text/parse_value.h"

namespace raycone {

std::optional<double> number_behind(const std::filesystem::path& file, const std::string& key) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    std::string value;
    words >> name >> value;
    if (name == key) return number_from(value);
  }
  return std::nullopt;
}

}  // namespace raycone
