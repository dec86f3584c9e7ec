#include "app/manual/manual_page.h"

#include <algorithm>
#include <cctype>

#include "app/command_line/command_spec.h"
#include "app/command_line/commands.h"
#include "app/process/version.h"

namespace raycone {
namespace {

// `text` as it is: with ASCII's own characters, which can be copied from the page, and nothing that means a request.
std::string literal(const std::string& text) {
  std::string result = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    switch (c) {
      case '\\':
        result += "\\e";
        break;
      case '-':
        result += "\\-";
        break;
      case '\'':
        result += "\\(aq";
        break;
      case '`':
        result += "\\(ga";
        break;
      case '^':
        result += "\\(ha";
        break;
      case '~':
        result += "\\(ti";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + literal(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + literal(text) + "\\fR"; }

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string section(const std::string& heading) { return ".SH " + upper(heading) + '\n'; }

std::string tagged(const std::string& tag, const std::string& description) {
  return ".TP\n" + tag + '\n' + literal(description) + '\n';
}

// "-o, --output OUT"
std::string tag_of(const OptionSpec& option) {
  std::string tag;
  for (const std::string& name : names_of(option)) tag += (tag.empty() ? "" : ", ") + bold(name);
  return option.value.empty() ? tag : tag + ' ' + italic(option.value);
}

std::string options_of(const OptionGroup& group) {
  std::string text = ".SS " + group.heading + '\n';
  for (const OptionSpec& option : group.options) text += tagged(tag_of(option), option.description);
  return text;
}

// "[POINTS]", "MESH..."
std::string usage_of(const OperandSpec& operand) {
  switch (operand.count) {
    case OperandCount::kOptional:
      return " [" + italic(operand.name) + "]";
    case OperandCount::kMany:
      return ' ' + italic(operand.name) + "...";
    case OperandCount::kOne:
      break;
  }
  return ' ' + italic(operand.name);
}

std::string usage_of(const CommandSpec& spec) {
  std::string text = bold(program_spec().name + ' ' + spec.name) + " [" + italic("OPTIONS") + "]";
  for (const OperandSpec& operand : spec.operands) text += usage_of(operand);
  return text + '\n';
}

std::string synopsis() {
  std::string text = section("Synopsis");
  for (const CommandEntry& entry : commands())
    text += (text.ends_with("SYNOPSIS\n") ? "" : ".br\n") + usage_of(entry.spec);
  return text;
}

std::string examples_of(const CommandSpec& spec) {
  std::string text = ".SS Examples\n.nf\n";
  for (const std::string& example : spec.examples) text += literal(example) + '\n';
  return text + ".fi\n";
}

std::string command_section(const CommandSpec& spec) {
  std::string text = section(program_spec().name + ' ' + spec.name) + literal(spec.description) + ".\n";
  for (const OperandSpec& operand : spec.operands) text += tagged(italic(operand.name), operand.description);
  for (const OptionGroup& group : spec.groups) {
    if (!group.heading.empty()) text += options_of(group);
  }
  return text + examples_of(spec);
}

std::string program_section() {
  std::string text = section("Description") + literal(program_spec().description) + ". The commands:\n";
  for (const CommandEntry& entry : commands()) text += tagged(bold(entry.spec.name), entry.spec.description);
  for (const OptionGroup& group : program_spec().groups) text += options_of(group);
  return text + examples_of(program_spec());
}

}  // namespace

std::string manual_page() {
  const CommandSpec& program = program_spec();
  std::string text = ".TH " + upper(program.name) + " 1 " + kReleaseDate + " \"" + program.name + ' ' + kVersion +
                     "\" \"User Commands\"\n";
  text += section("Name") + program.name + " \\- " + literal(program.description) + '\n';
  text += synopsis() + program_section();
  for (const CommandEntry& entry : commands()) text += command_section(entry.spec);
  for (const NoteSpec& note : program.notes) text += section(note.heading) + literal(note.text) + ".\n";
  return text;
}

}  // namespace raycone
