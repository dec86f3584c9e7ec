// Reading meshes and writing fields, in MB/s, beside plain baselines in the same run: getting the bytes and finding the
// line ends, or handing over as many bytes, which nothing that reads or writes a file can beat by much; and printf.
// Each reports a check: what was read, or how many bytes were written.
#include "tests/bench/io_bench.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "io/fields/field_writer.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/shapes.h"

namespace raycone::bench {
namespace {

std::string print(const char* format, double x, double y, double z) {
  char text[128];
  return {text, static_cast<std::size_t>(std::snprintf(text, sizeof text, format, x, y, z))};
}

std::string print_face(const char* format, const Triangle& t, unsigned base) {
  char text[64];
  return {text,
          static_cast<std::size_t>(std::snprintf(text, sizeof text, format, t[0] + base, t[1] + base, t[2] + base))};
}

template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// A mesh in a format by its name here: that of the file, before its dot whether it is text.
std::string mesh_file(const TriangleMesh& mesh, const std::string& name) {
  std::string text;
  if (name == "text.obj") {
    for (const Vec3& v : mesh.vertices) text += print("v %.6f %.6f %.6f\n", v.x, v.y, v.z);
    for (const Triangle& t : mesh.triangles) text += print_face("f %u %u %u\n", t, 1);
  } else if (name == "text.off") {
    text = "OFF\n" + std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n";
    for (const Vec3& v : mesh.vertices) text += print("%.6f %.6f %.6f\n", v.x, v.y, v.z);
    for (const Triangle& t : mesh.triangles) text += print_face("3 %u %u %u\n", t, 0);
  } else if (name == "text.stl") {
    text = "solid s\n";
    for (const Triangle& t : mesh.triangles) {
      text += "facet normal 0 0 1\nouter loop\n";
      for (const std::uint32_t i : t) {
        text += print("vertex %.6e %.6e %.6e\n", mesh.vertices[i].x, mesh.vertices[i].y, mesh.vertices[i].z);
      }
      text += "endloop\nendfacet\n";
    }
    text += "endsolid s\n";
  } else if (name == "binary.stl") {
    text.assign(80, ' ');
    append(text, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
      text.append(12, '\0');
      for (const std::uint32_t i : t) {
        for (int axis = 0; axis < 3; ++axis) append(text, static_cast<float>(mesh.vertices[i][axis]));
      }
      text.append(2, '\0');
    }
  } else {
    const bool binary = name == "binary.ply";
    text = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") + " 1.0\nelement vertex " +
           std::to_string(mesh.vertices.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
           std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& v : mesh.vertices) {
      if (!binary) text += print("%.6f %.6f %.6f\n", v.x, v.y, v.z);
      for (int axis = 0; binary && axis < 3; ++axis) append(text, static_cast<float>(v[axis]));
    }
    for (const Triangle& t : mesh.triangles) {
      if (!binary) text += print_face("3 %u %u %u\n", t, 0);
      if (binary) text += '\3';
      for (std::size_t i = 0; binary && i < 3; ++i) append(text, t[i]);
    }
  }
  return text;
}

void time_reading(benchmark::State& state, const std::string& path) {
  const ThreadLimit limit(1);
  std::size_t faces = 0;
  for (auto _ : state) faces = read_mesh(path).parsed.mesh.triangles.size();
  state.counters["faces"] = static_cast<double>(faces);
  state.SetBytesProcessed(static_cast<std::int64_t>(std::filesystem::file_size(path)) * state.iterations());
}

void time_line_ends(benchmark::State& state, const std::string& path) {
  std::size_t lines = 0;
  for (auto _ : state) {
    std::string bytes(std::filesystem::file_size(path), '\0');
    std::ifstream(path, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    lines = 0;
    const char *at = bytes.data(), *end = at + bytes.size();
    while (at < end && (at = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at))))) {
      ++lines;
      ++at;
    }
  }
  state.counters["lines"] = static_cast<double>(lines);
  state.SetBytesProcessed(static_cast<std::int64_t>(std::filesystem::file_size(path)) * state.iterations());
}

// A field of a closed sphere, and random points with a number each.
struct Fields {
  Lattice lattice;
  std::vector<double> values;
  std::vector<Vec3> points;

  Fields(const TriangleMesh& mesh, std::int64_t side) {
    lattice.origin = {-1.1, -1.1, -1.1};
    lattice.spacing = (1.0 / static_cast<double>(side - 1)) * Vec3{2.2, 2.2, 2.2};
    lattice.counts = {side, side, side};
    values.resize(static_cast<std::size_t>(whole(lattice).size()));
    WindingNumberEvaluator(mesh).evaluate(lattice, whole(lattice), values);
    std::mt19937_64 random(1);
    const auto coordinate = [&] { return std::ldexp(static_cast<double>(random() >> 11), -52) - 1.0; };
    for (std::size_t i = 0; i < values.size() / 8; ++i) points.push_back({coordinate(), coordinate(), coordinate()});
  }
};

// What it takes to write a file of this format, and to rename it; the disk's part is that of the baseline.
void time_writing(benchmark::State& state, const std::string& path, const std::function<void(OutputFile&)>& write) {
  const ThreadLimit limit(1);
  for (auto _ : state) {
    OutputFile output(path);
    write(output);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(std::filesystem::file_size(path)) * state.iterations());
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
}

void write_lattice(FieldFormat format, const Fields& fields, OutputFile& output) {
  const auto writer = make_lattice_writer(format, output, fields.lattice, {});
  const FieldValues values = std::span<const double>(fields.values);
  writer->write(whole(fields.lattice), {&values, 1});
  writer->finish({});
}

void write_points(FieldFormat format, const Fields& fields, OutputFile& output) {
  const auto writer = make_point_writer(format, output, fields.points.size(), {});
  const FieldValues values = std::span<const double>(fields.values).first(fields.points.size());
  writer->write(fields.points, {&values, 1});
  writer->finish();
}

void write_points_by_printf(const Fields& fields, OutputFile& output) {
  char row[128];
  for (std::size_t i = 0; i < fields.points.size(); ++i) {
    const Vec3& p = fields.points[i];
    output.write(row, static_cast<std::size_t>(std::snprintf(row, sizeof row, "%.17g,%.17g,%.17g,%.17g\n", p.x, p.y,
                                                             p.z, fields.values[i])));
  }
  output.commit();
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), body)->Unit(benchmark::kMillisecond)->UseRealTime();
}

}  // namespace

void add_io_benchmarks(const std::filesystem::path& directory) {
  const TriangleMesh mesh = test::sphere(320);
  for (const std::string name : {"text.obj", "text.off", "text.ply", "text.stl", "binary.ply", "binary.stl"}) {
    const std::string path = directory / name;
    std::ofstream(path, std::ios::binary) << mesh_file(mesh, name);
    add("read_format/" + name, [path](benchmark::State& state) { time_reading(state, path); });
    add("line_ends/" + name, [path](benchmark::State& state) { time_line_ends(state, path); });
  }
  const auto fields = std::make_shared<const Fields>(mesh, 200);
  const auto add_writing = [&](const std::string& name, const std::function<void(OutputFile&)>& write) {
    add("write_format/" + name,
        [path = (directory / name).string(), write](benchmark::State& state) { time_writing(state, path, write); });
  };
  const std::vector<std::pair<std::string, FieldFormat>> formats{
      {"csv", FieldFormat::kCsv}, {"npy", FieldFormat::kNpy}, {"vti", FieldFormat::kVti}, {"vdb", FieldFormat::kVdb}};
  for (const auto& [name, format] : formats) {
    add_writing("lattice." + name,
                [=, format = format](OutputFile& output) { write_lattice(format, *fields, output); });
  }
  add_writing("points.csv", [=](OutputFile& output) { write_points(FieldFormat::kCsv, *fields, output); });
  add_writing("points.printf", [=](OutputFile& output) { write_points_by_printf(*fields, output); });
  add_writing("bytes", [=](OutputFile& output) {
    output.write(fields->values.data(), fields->values.size() * sizeof(double));
    output.commit();
  });
}

}  // namespace raycone::bench
