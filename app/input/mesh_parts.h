// The meshes of a job with labels, and the parts that they consist of. Parts are handed out one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/input/mesh_input.h"
#include "app/input/run_limits.h"
#include "app/options/mesh_options.h"
#include "core/data/triangle_mesh.h"
#include "core/data/warning.h"
#include "core/mesh/mesh_split.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// What the mesh of all parts together is wanted for.
enum class WholeMesh {
  kUnused,
  kShown,      // drawn
  kEvaluated,  // or drawn from: warnings and counts of orientation are about it
};

class MeshParts {
 public:
  struct File {
    FileRead read;
    std::string unit;  // of its coordinates, where the format has one
    std::vector<FileRead> companions;
    std::uint64_t vertices = 0, faces = 0;
    std::vector<Warning> warnings;
  };

  // Reads all files once, so that what is wrong with one is known before the work. Of several files, small ones are
  // kept; others are read again when their turn comes, so that memory does not grow with their number. But all are kept
  // where the mesh of all is used, or to normalize them. Throws as read_mesh_file(), and InputError where groups are
  // asked for and the format has none. `options` and `limits` must outlive this.
  MeshParts(const MeshOptions& options, const RunLimits& limits, WholeMesh whole);

  [[nodiscard]] const std::vector<File>& files() const { return files_; }
  [[nodiscard]] const Matrix4& transform() const { return transform_; }
  // The box of all files. With a distance to weld within, which moves vertices, each file is welded by itself first, as
  // in a run of it alone.
  [[nodiscard]] const Box& box() const { return box_; }

  // At least one.
  [[nodiscard]] std::size_t size() const { return names_.size(); }
  // From the part's file, group or number; never empty.
  [[nodiscard]] const std::string& name(std::size_t part) const { return names_[part]; }
  [[nodiscard]] std::size_t file_of(std::size_t part) const { return files_.size() > 1 ? part : 0; }

  // The mesh of all parts. Precondition: it is used (WholeMesh), or there is only one file.
  [[nodiscard]] const TriangleMesh& whole() const { return split_->whole(); }

  // A part, welded but not yet oriented; ask for each part once. Warnings about the welding are appended to `warnings`.
  // Throws as read_mesh_file(), and InputError where the file has changed since it was read first.
  [[nodiscard]] TriangleMesh part(std::size_t part, std::vector<Warning>& warnings);

 private:
  TriangleMesh read(std::size_t file);
  void keep_all();
  void keep_some();
  [[nodiscard]] Box welded_box(TriangleMesh mesh) const;
  void extend_box(const Box& box) { box_ = hull(box_, box); }
  void name_parts(TriangleMesh& all, std::vector<std::uint32_t>& part_of);
  void name_groups(std::vector<std::uint32_t>& part_of);

  const MeshOptions& options_;
  const RunLimits& limits_;
  std::vector<File> files_;
  std::vector<std::string> names_;
  FaceGroups groups_;  // of the only file, until they have become parts
  Matrix4 transform_{};
  Box box_ = empty_box();
  std::optional<MeshSplit> split_;                 // of all; absent where files are kept one by one, or not at all
  std::vector<std::optional<TriangleMesh>> kept_;  // of each file then, welded
};

}  // namespace raycone
