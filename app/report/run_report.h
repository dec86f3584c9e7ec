// What a run tells its user when it is done: one summary line, and the numbers behind it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/data/placed_lattice.h"
#include "core/data/warning.h"
#include "core/evaluation/winding_number.h"
#include "core/orientation/orient.h"
#include "io/files/output_file.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

struct Seconds {
  double read = 0.0;      // mesh and points: parsing and hashing
  double prepare = 0.0;   // all that depends on the mesh alone: welding, exterior edges, acceleration structures
  double evaluate = 0.0;  // the rest of the evaluation, and drawing the points that it is of
  double write = 0.0;
  double verify = 0.0;  // where asked for
  double total = 0.0;
};

// What verification found (app/fields/verify.h).
struct Verification {
  std::uint64_t samples = 0;                            // compared
  std::uint64_t on_surface = 0;                         // of these; the value there is that of the perturbed query
  std::uint64_t unresolved = 0;                         // drawn, but not known well enough by definition: not compared
  double largest_difference = 0.0;                      // of winding numbers and densities
  double largest_bound = 0.0;                           // of the values' error bounds
  std::optional<double> largest_distance_difference{};  // world units; where distances are wanted
  std::optional<double> largest_gradient_difference{};  // of components, per world unit; where gradients are wanted

  // Adds what was found of the same samples by another one of their fields. `samples` are at most those that either
  // compared.
  void merge(const Verification& other);
};

// What `raycone surface` made; the surface has been checked.
struct SurfaceReport {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::uint64_t components = 0;
  double max_distance = 0.0;  // of vertices from the mesh, but in holes; world units
  double hole_area = 0.0;
  double dropped_area = 0.0;
};

// A part that labels tell apart; the n-th one has the label n, from 1.
struct PartReport {
  std::string name;
  std::string mesh;  // its file
  std::uint64_t faces = 0;
  std::uint64_t exterior_edges = 0;
  std::uint64_t samples = 0;  // that have its label
};

struct RunReport {
  // Adds what one more verification of this run found.
  void add_verification(const Verification& found);

  std::string mesh;                     // files as named on the command line
  std::vector<std::string> files_read;  // the mesh and what it refers to, points, the grid of --like
  std::vector<FileRead> companions;     // what the mesh refers to
  std::string sha256;
  std::string unit;               // of the mesh file's coordinates, where its format has one
  std::vector<FileRead> meshes;   // all of them, where there are labels
  std::vector<PartReport> parts;  // likewise
  std::string output;
  std::vector<std::string> command;  // its words, as given; empty where a batch gave it
  std::vector<std::string> options;  // those of it that results depend on
  std::uint64_t vertices = 0;        // as read, before welding
  std::uint64_t faces = 0;
  OrientationCounts orientation;
  std::uint64_t exterior_edges = 0;
  std::array<double, 16> transform{};  // from the file's coordinates to the world's, row by row
  std::uint64_t samples = 0;
  std::optional<PlacedLattice> lattice;  // absent for points
  int threads = 0;
  Tally tally;
  Terms terms;
  double largest_error_bound = 0.0;          // of winding numbers, turns
  std::optional<Verification> verification;  // where asked for
  std::optional<SurfaceReport> surface;      // where one was made
  std::uint64_t peak_memory_bytes = 0;
  std::vector<Warning> warnings;
  Seconds seconds;
  std::vector<PlacedFile> placed;  // what was written, but for pipes and devices
};

// "bunny.obj: 69451 faces, 223 exterior edges, 125000 samples in 0.42 s (read 0.05, ...) -> bunny.vdb", and, where
// asked for, ", verified 100 samples, largest difference 3e-16"
[[nodiscard]] std::string summary_line(const RunReport& report);

}  // namespace raycone
