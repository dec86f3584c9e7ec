// One file without references to others, readable without scripts; the only one sorts and filters the tables.
#include "app/batch/report_page.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "app/batch/batch_record.h"
#include "app/batch/report_assets.h"
#include "app/batch/results_files.h"
#include "app/batch/svg_plot.h"
#include "app/input/written_files.h"
#include "app/process/messages.h"
#include "app/process/progress.h"
#include "app/process/usage_error.h"
#include "app/process/version.h"
#include "app/text/html.h"
#include "app/text/readable_count.h"
#include "io/files/ascii.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/output_file.h"
#include "io/files/readable_bytes.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

using Quantities = std::vector<double>;

bool is_ok(const BatchRecord& record) { return record.row.status == MeshStatus::kOk; }

// One number of each mesh that was evaluated.
Quantities collect(const BatchRecords& records, const std::function<double(const MeshFigures&)>& quantity) {
  Quantities all;
  for (const auto& [mesh, record] : records) {
    if (is_ok(record)) all.push_back(quantity(*record.row.figures));
  }
  return all;
}

double sum(const Quantities& quantities) {
  double total = 0.0;
  for (const double quantity : quantities) total += quantity;
  return total;
}

double faces_of(const MeshFigures& f) { return static_cast<double>(f.faces); }
double edges_of(const MeshFigures& f) { return static_cast<double>(f.exterior_edges); }
double samples_of(const MeshFigures& f) { return static_cast<double>(f.samples); }

// --- Warnings -------------------------------------------------------------------------------------------------------

constexpr const char* kNoWarning = "none";

// Of each name, how many meshes have it.
std::map<std::string, std::size_t> count_warnings(const BatchRecords& records) {
  std::map<std::string, std::size_t> counts;
  for (const auto& [mesh, record] : records) {
    std::istringstream names(record.row.warnings);
    names.exceptions(std::ios_base::badbit);  // lest it take a lack of memory for its end
    for (std::string name; names >> name;) ++counts[name];
  }
  return counts;
}

std::size_t count_warned(const BatchRecords& records) {
  return static_cast<std::size_t>(
      std::ranges::count_if(records, [](const auto& record) { return !record.second.row.warnings.empty(); }));
}

std::string filter_button(const std::string& name, const std::string& label, std::size_t count) {
  return "<button type=\"button\" data-f=\"" + html_text(name) + "\">" + html_text(label) + ' ' +
         std::to_string(count) + "</button>\n";
}

std::string warnings(const BatchRecords& records) {
  const std::map<std::string, std::size_t> counts = count_warnings(records);
  if (counts.empty()) return "";
  std::string html = "<h2>Warnings</h2>\n<div class=\"filter\">\n" + filter_button("", "all meshes", records.size());
  for (const auto& [name, count] : counts) html += filter_button(name, name, count);
  return html + filter_button(kNoWarning, kNoWarning, records.size() - count_warned(records)) + "</div>\n";
}

// Of a table about meshes, its first cells yet to come.
std::string row_start(const ResultRow& row) {
  return "<tr data-w=\"" + html_text(row.warnings.empty() ? kNoWarning : row.warnings) + "\">";
}

// The message has no column of its own: it would be cut off where the page is narrow.
std::string mesh_cell(const std::string& mesh, const std::string& message) {
  const std::string below = message.empty() ? "" : "<div class=\"message\">" + html_text(message) + "</div>";
  return "<td><div class=\"name\">" + html_text(mesh) + "</div>" + below + "</td>";
}

std::string warning_cell(const ResultRow& row) { return "<td class=\"warnings\">" + html_text(row.warnings) + "</td>"; }

// --- Head -----------------------------------------------------------------------------------------------------------

// "2026-11-26 23:40 UTC"
std::string readable_date(std::int64_t nanoseconds) {
  const auto seconds = static_cast<std::time_t>(nanoseconds / 1'000'000'000);
  std::tm date{};
  char text[64];
  if (!gmtime_r(&seconds, &date) || std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &date) == 0) return "";
  return text;
}

// When meshes were finished and by which options, as the results tell: the same results make the same page.
std::string provenance(const BatchRecords& records) {
  std::vector<std::int64_t> times;
  std::map<std::string, std::size_t> meshes_by_options;
  for (const auto& [mesh, record] : records) {
    if (!record.origin) continue;
    times.push_back(record.origin->finished);
    std::string options = record.origin->options;
    std::ranges::replace(options, '\n', ' ');
    if (!options.empty()) ++meshes_by_options[options];
  }
  std::string html;
  if (!times.empty()) {
    const auto [first, last] = std::ranges::minmax(times);
    const std::string begin = readable_date(first), end = readable_date(last);
    html += "<br>\nMeshes finished " + (begin == end ? begin : begin + " to " + end);
  }
  for (const auto& [options, meshes] : meshes_by_options) {
    const std::string whose = meshes_by_options.size() > 1 ? counted(meshes, "mesh") + ": " : "";
    html += "<br>\n" + whose + "<code>" + html_text(options) + "</code>";
  }
  return html;
}

// --- Summary --------------------------------------------------------------------------------------------------------

// "1.25 ms", "99 s", "1:00:00".
std::string readable_duration(double seconds) {
  constexpr double kLong = 120.0;
  return seconds < kLong ? readable_quantity(seconds, Quantity::kSeconds) : readable_time(seconds);
}

std::string tile(const std::string& value, const std::string& name, bool bad = false) {
  return std::string("<div class=\"tile") + (bad ? " bad" : "") + "\"><b>" + html_text(value) + "</b>" +
         html_text(name) + "</div>\n";
}

std::string tiles(const BatchRecords& records) {
  std::map<MeshStatus, std::size_t> counts;
  for (const auto& [mesh, record] : records) ++counts[record.row.status];
  std::string html = "<div class=\"tiles\">\n" + tile(std::to_string(records.size()), "meshes");
  for (const auto& [status, count] : counts)
    html += tile(std::to_string(count), name_of(status), status != MeshStatus::kOk);
  if (const std::size_t warned = count_warned(records)) html += tile(std::to_string(warned), "with warnings");
  const double samples = sum(collect(records, samples_of));
  const double seconds = sum(collect(records, [](const MeshFigures& f) { return f.seconds(); }));
  html += tile(readable_quantity(samples, Quantity::kCount), "samples");
  html += tile(readable_duration(seconds), "in all meshes together");
  if (seconds > 0.0) html += tile(readable_quantity(samples / seconds, Quantity::kCount), "samples per second");
  return html + "</div>\n";
}

// --- Plots ----------------------------------------------------------------------------------------------------------

using Figure = double (*)(const MeshFigures&);

struct PlottedQuantity {
  PlotAxis axis;
  Figure figure;
};

const PlottedQuantity kFaces{{"faces", Quantity::kCount}, faces_of};
const PlottedQuantity kEdges{{"exterior edges (0: closed)", Quantity::kCount}, edges_of};
const PlottedQuantity kPrepare{{"prepare", Quantity::kSeconds}, [](const MeshFigures& f) { return f.prepare_s; }};
const PlottedQuantity kEvaluate{{"evaluate", Quantity::kSeconds}, [](const MeshFigures& f) { return f.evaluate_s; }};
const PlottedQuantity kTotal{{"read, prepare, evaluate and write", Quantity::kSeconds},
                             [](const MeshFigures& f) { return f.seconds(); }};

std::string scatter(const BatchRecords& records, const PlottedQuantity& x, const PlottedQuantity& y) {
  std::vector<PlotPoint> points;
  for (const auto& [mesh, record] : records) {
    if (is_ok(record)) points.push_back({x.figure(*record.row.figures), y.figure(*record.row.figures), mesh});
  }
  return "<figure>" + scatter_plot(x.axis, y.axis, points) + "</figure>\n";
}

std::string plots(const BatchRecords& records) {
  std::string html = "<h2>Time against size</h2>\n<div class=\"plots\">\n";
  for (const PlottedQuantity* const time : {&kPrepare, &kEvaluate}) {
    for (const PlottedQuantity* const size : {&kFaces, &kEdges}) html += scatter(records, *size, *time);
  }
  html += "</div>\n<h2>Distributions</h2>\n<div class=\"plots\">\n";
  for (const PlottedQuantity* const quantity : {&kTotal, &kFaces, &kEdges}) {
    html += "<figure>" + histogram(quantity->axis, collect(records, quantity->figure)) + "</figure>\n";
  }
  return html + "</div>\n";
}

// --- Tables ---------------------------------------------------------------------------------------------------------

std::string number_cell(double value, const std::string& text) {
  return "<td class=\"n\" data-v=\"" + with_digits(value, 9) + "\">" + html_text(text) + "</td>";
}

std::string count_cell(std::uint64_t count) {
  constexpr const char* kNarrowBlank = "\xE2\x80\xAF";  // where lines do not break
  return number_cell(static_cast<double>(count), grouped(count, kNarrowBlank));
}

std::string time_cell(double seconds) { return number_cell(seconds, readable_duration(seconds)); }

std::string figure_cells(const MeshFigures& f) {
  return count_cell(f.faces) + count_cell(f.exterior_edges) + count_cell(f.samples) + time_cell(f.read_s) +
         time_cell(f.prepare_s) + time_cell(f.evaluate_s) + time_cell(f.write_s) +
         number_cell(static_cast<double>(f.peak_memory_bytes),
                     readable_bytes(static_cast<double>(f.peak_memory_bytes)));
}

std::string thumbnail_of(const BatchRecord& record) { return record.origin ? record.origin->thumbnail : ""; }

std::string thumbnail_cell(const BatchRecord& record) {
  const std::string image = thumbnail_of(record);
  if (image.empty()) return "<td></td>";
  return "<td><img alt=\"\" loading=\"lazy\" src=\"data:image/bmp;base64," + html_text(image) + "\"></td>";
}

std::string failures(const BatchRecords& records) {
  std::string rows;
  for (const auto& [mesh, record] : records) {
    if (is_ok(record)) continue;
    rows += row_start(record.row) + mesh_cell(mesh, record.row.message) + "<td class=\"bad\">" +
            name_of(record.row.status) + "</td>" + warning_cell(record.row) + "</tr>\n";
  }
  if (rows.empty()) return "";
  return "<section>\n<h2>Failures</h2>\n<div class=\"scroll\"><table><thead><tr><th class=\"sort\">mesh</th>"
         "<th class=\"sort\">cause</th><th class=\"sort\">warnings</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n</section>\n";
}

std::string evaluated(const BatchRecords& records) {
  // Points have no layers.
  const bool has_images = std::ranges::any_of(records, [](const auto& r) { return !thumbnail_of(r.second).empty(); });
  std::string html = std::string("<section>\n<h2>Meshes</h2>\n<div class=\"scroll\"><table><thead><tr>") +
                     (has_images ? "<th>middle layer</th>" : "") + "<th class=\"sort\">mesh</th>";
  for (const char* const column :
       {"faces", "exterior edges", "samples", "read", "prepare", "evaluate", "write", "peak memory"}) {
    html += std::string("<th class=\"n sort\">") + column + "</th>";
  }
  html += "<th class=\"sort\">warnings</th></tr></thead><tbody>\n";
  for (const auto& [mesh, record] : records) {
    if (!is_ok(record)) continue;
    html += row_start(record.row) + (has_images ? thumbnail_cell(record) : "") + mesh_cell(mesh, record.row.message) +
            figure_cells(*record.row.figures) + warning_cell(record.row) + "</tr>\n";
  }
  return html + "</tbody></table></div>\n</section>\n";
}

std::string gaps(const std::vector<std::string>& missing) {
  std::string html;
  for (const std::string& line : missing) html += "<p class=\"bad\">There are " + html_text(line) + ".</p>\n";
  return html;
}

std::string page(const std::string& directory, const BatchRecords& records, const std::vector<std::string>& missing) {
  const std::string title = html_text("raycone batch: " + directory);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
         title + "</title>\n<style>" + kReportStyle + "</style>\n</head>\n<body>\n<h1>" + title +
         "</h1>\n<div class=\"quiet\">raycone " + kVersion + provenance(records) + "</div>\n" + gaps(missing) +
         tiles(records) + failures(records) + plots(records) + warnings(records) + evaluated(records) + "<script>" +
         kReportScript + "</script>\n</body>\n</html>\n";
}

std::vector<std::string> results_in(const std::string& directory) {
  std::vector<std::string> results;
  for (const std::string& name : names_in(directory)) {
    if (is_results_file(name)) results.push_back((fs::path(directory) / name).string());
  }
  return results;
}

// Those that shards are yet to write included.
void refuse_to_replace_results(const ReportCommand& command) {
  std::error_code error;
  refuse_to_replace_input({{command.output, "report"}}, results_in(command.directory));
  const fs::path target = follow_links(command.output);
  if (is_results_file(target.filename().string()) &&
      fs::equivalent(directory_of(target.string()), command.directory, error)) {
    throw UsageError(command.output + ": is a name for results of a batch, expected another one for the report");
  }
}

}  // namespace

std::size_t write_report_page(const ReportCommand& command) {
  refuse_to_replace_results(command);
  const BatchRecords records = read_all_results(command.directory);
  if (records.empty() && std::ranges::none_of(names_in(command.directory), holds_rows)) {
    throw InputError(command.directory + ": no results, expected the directory of a batch, with its results.csv");
  }
  const std::vector<std::string> missing = missing_shards(command.directory);
  if (!command.run.quiet) {
    warn_of_unreadable_rows(command.directory);
    for (const std::string& line : missing) print_message("warning: " + command.directory + ": " + line);
  }
  OutputFile output(command.output, command.existing);
  write_all(output, page(command.directory, records, missing));
  return records.size();
}

}  // namespace raycone
