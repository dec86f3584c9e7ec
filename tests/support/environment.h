// Environment variables for a while, as tests need them or must not have them.
#pragma once

#include <cstdlib>
#include <map>
#include <optional>
#include <string>

namespace raycone::test {

// For the life of this each variable has this value, or is not set. Of this process and of those that it starts.
class Environment {
 public:
  using Variables = std::map<std::string, std::optional<std::string>>;

  explicit Environment(const Variables& variables) {
    for (const auto& [name, value] : variables) {
      const char* const earlier = std::getenv(name.c_str());
      earlier_.emplace(name, earlier ? std::optional<std::string>(earlier) : std::nullopt);
      set(name, value);
    }
  }
  ~Environment() {
    for (const auto& [name, value] : earlier_) set(name, value);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  static void set(const std::string& name, const std::optional<std::string>& value) {
    if (value) {
      setenv(name.c_str(), value->c_str(), 1);
    } else {
      unsetenv(name.c_str());
    }
  }

  Variables earlier_;
};

// Also where the tests run in a task of an array job of Slurm's: `--shard slurm` knows of none.
inline Environment outside_array_jobs() { return Environment({{"SLURM_ARRAY_TASK_ID", std::nullopt}}); }

}  // namespace raycone::test
