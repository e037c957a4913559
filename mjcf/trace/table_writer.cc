// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/table_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/text.h"

namespace tauext {
namespace {

constexpr std::pair<const char*, TableFormat> kFormats[] = {{"text", TableFormat::kText},
                                                            {"csv", TableFormat::kCsv},
                                                            {"json", TableFormat::kJson},
                                                            {"md", TableFormat::kMarkdown},
                                                            {"latex", TableFormat::kLatex}};

bool marked(const std::string& cell) {
  return cell.ends_with(TableWriter::kMark);
}

std::string unmarked(std::string cell) {
  if (marked(cell)) cell.pop_back();
  return cell;
}

// columns are counted in characters, of which UTF-8 has up to four bytes
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return left ? text + space : space + text;
}

std::string escaped(const std::string& text, std::string_view special, const char* before) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += before;
    out += c;
  }
  return out;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  return '"' + escaped(text, "\"", "\"") + '"';
}

std::string json_value(const std::string& text) {
  if (text == "-" || text == "never" || text.empty()) return "null";
  return finite_number_in(text) ? text : '"' + escaped(text, "\"\\", "\\") + '"';
}

// a name for programs: "title_unit" without what no key should hold
std::string key_of(const TableWriter::Column& c) {
  std::string unit = c.unit, key;
  std::erase(unit, ' ');
  for (const char x : unit.empty() ? c.title : c.title + "_" + unit) {
    if (x == '%') {
      key += "percent";
    } else {
      key += x == ' ' || x == '/' ? '_' : x;
    }
  }
  return escaped(key, "\"\\", "\\");
}

}  // namespace

TableFormat table_format(std::string_view name) {
  return find_known(kFormats, "format", name, [](const auto& f) { return f.first; }).second;
}

void TableWriter::add(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) {
    throw std::logic_error(fmt::format("{} cells for {} columns", cells.size(), columns_.size()));
  }
  for (std::string& cell : cells) cell = printable_name(cell, cell.size());
  rows_.push_back({std::move(cells), ""});
}

void TableWriter::add_note(const std::string& text) {
  rows_.push_back({{}, printable(text)});
}

void TableWriter::add_gap() {
  rows_.push_back({});
}

std::string TableWriter::format(TableFormat format) const {
  switch (format) {
    case TableFormat::kText:
      return text();
    case TableFormat::kCsv:
      return csv();
    case TableFormat::kJson:
      return json();
    case TableFormat::kMarkdown:
      return markdown();
    case TableFormat::kLatex:
      return latex();
  }
  return "";
}

std::string TableWriter::text() const {
  std::vector<std::size_t> widths;
  std::vector<bool> has_marks;
  bool has_units = false;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::size_t width =
        std::max({columns_[c].width, width_of(columns_[c].title), width_of(columns_[c].unit)});
    bool marks = false;
    for (const Row& r : rows_) {
      if (r.cells.empty()) continue;
      width = std::max(width, width_of(unmarked(r.cells[c])));
      marks = marks || marked(r.cells[c]);
    }
    widths.push_back(width);
    has_marks.push_back(marks);
    has_units = has_units || !columns_[c].unit.empty();
  }
  const auto line = [&](auto&& cell_of) {
    std::string out;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::string cell = cell_of(c);
      out += (c > 0 ? "  " : "") + padded(unmarked(cell), widths[c], columns_[c].left);
      if (has_marks[c]) out += marked(cell) ? kMark : ' ';
    }
    out.erase(out.find_last_not_of(' ') + 1);
    return out + "\n";
  };
  std::string out = line([&](std::size_t c) { return columns_[c].title; });
  if (has_units) out += line([&](std::size_t c) { return columns_[c].unit; });
  for (const Row& r : rows_) {
    out += r.cells.empty() ? r.note + "\n" : line([&](std::size_t c) { return r.cells[c]; });
  }
  return out;
}

std::string TableWriter::csv() const {
  std::vector<std::string> names;
  for (const Column& c : columns_) names.push_back(csv_field(key_of(c)));
  std::string out = fmt::format("{}\n", fmt::join(names, ","));
  for (const Row& r : rows_) {
    if (r.cells.empty()) continue;
    std::vector<std::string> cells;
    for (const std::string& cell : r.cells) cells.push_back(csv_field(unmarked(cell)));
    out += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return out;
}

std::string TableWriter::json() const {
  std::vector<std::string> objects;
  for (const Row& r : rows_) {
    std::vector<std::string> members;
    for (std::size_t c = 0; c < r.cells.size(); ++c) {
      members.push_back(
          fmt::format("\"{}\": {}", key_of(columns_[c]), json_value(unmarked(r.cells[c]))));
    }
    if (!r.cells.empty()) objects.push_back(fmt::format("  {{{}}}", fmt::join(members, ", ")));
  }
  return fmt::format("[\n{}\n]\n", fmt::join(objects, ",\n"));
}

std::string TableWriter::markdown() const {
  std::string titles = "|", rules = "|", out;
  for (const Column& c : columns_) {
    titles += fmt::format(" {}{} |", escaped(c.title, "|", "\\"),
                          c.unit.empty() ? "" : fmt::format(" [{}]", c.unit));
    rules += c.left ? "---|" : "--:|";
  }
  for (const Row& r : rows_) {
    if (r.cells.empty()) continue;
    out += "|";
    for (const std::string& cell : r.cells) {
      const std::string value = escaped(unmarked(cell), "|", "\\");
      out += marked(cell) ? fmt::format(" **{}** |", value) : fmt::format(" {} |", value);
    }
    out += "\n";
  }
  return titles + "\n" + rules + "\n" + out;
}

std::string TableWriter::latex() const {
  const auto tex = [](const std::string& text) {
    std::string out = escaped(text, "_%&#$", "\\");
    if (const auto at = out.find("+-"); at != out.npos) out.replace(at, 2, "$\\pm$");
    return out;
  };
  std::string alignment, titles, units, out;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    alignment += columns_[c].left ? 'l' : 'r';
    titles += (c > 0 ? " & " : "") + tex(columns_[c].title);
    units += (c > 0 ? " & " : "") + tex(columns_[c].unit);
  }
  for (const Row& r : rows_) {
    for (std::size_t c = 0; c < r.cells.size(); ++c) {
      const std::string value = tex(unmarked(r.cells[c]));
      out += (c > 0 ? " & " : "") +
             (marked(r.cells[c]) ? fmt::format("\\textbf{{{}}}", value) : value);
    }
    if (!r.cells.empty()) out += " \\\\\n";
  }
  return fmt::format(
      "\\begin{{tabular}}{{{}}}\n\\hline\n{} \\\\\n{} \\\\\n\\hline\n{}\\hline\n\\end{{tabular}}\n",
      alignment, titles, units, out);
}

}  // namespace tauext
