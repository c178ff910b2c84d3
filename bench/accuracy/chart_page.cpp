#include <cstdio>

#include "bench/accuracy/chart_figure.hpp"

namespace cycloid::accuracy {

static std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

/// As part of a URL: all but letters, digits and what URLs leave alone.
static std::string percent_encoded(const std::string& text) {
  static const std::string kPlain = "-._~!*()/:;,=+ ";
  std::string result;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain || kPlain.find(c) != std::string::npos) {
      result += c;
      continue;
    }
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned char>(c));
    result += code;
  }
  return result;
}

static std::string cell(const std::string& text) {
  return "<td>" + escaped(text) + "</td>";
}

static std::string front_table(const SceneChart& chart, const ErrorKind& error) {
  std::string text = "<table><tr><th>on the front<th>rows a tick<th>us a tick<th>";
  text += escaped(error.label) + "<th>digest</tr>\n";
  for (const std::size_t index : pareto_front(chart, error, table_axis(chart))) {
    const ChartPoint& point = chart.points[index];
    char digest[32];
    std::snprintf(digest, sizeof digest, "%016llx",
                  static_cast<unsigned long long>(point.measured.digest));
    text += "<tr>" + cell(name_of(point.measured.setting)) +
            cell(point.measured.price.rows_per_tick > 0.0
                     ? short_number(point.measured.price.rows_per_tick)
                     : "") +
            cell(point.times.empty() ? "" : short_number(1e-3 * point.measured.price.ns_per_tick)) +
            cell(short_number(error.of(point.measured).value_or(0.0))) +
            cell(point.measured.digest != 0 ? digest : "") + "</tr>\n";
  }
  return text + "</table>\n";
}

static constexpr const char* kHead =
    "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Error against cost</title>\n"
    "<style>body{font:15px sans-serif;margin:2em auto;max-width:1040px}"
    "td,th{padding:0 1em 0 0;text-align:left;font-weight:normal}th{color:#666}"
    "object{width:1000px;height:420px}</style>\n<h1>Error against cost</h1>\n";

std::string chart_page(const ChartPlan& plan, const std::vector<const ErrorKind*>& errors,
                       const std::vector<std::string>& svgs, const ChartOrigin& origin) {
  std::string page = kHead;
  page += "<p>" +
          escaped(origin.machine + ", compiler " + origin.compiler + ", commit " + origin.commit +
                  ", " + origin.date) +
          ". Point at a mark to see what it is; drag with the right button to enlarge. A cross is "
          "a setting that failed.</p>\n";
  std::size_t next = 0;
  for (const SceneChart& chart : plan.scenes) {
    page += "<h2>" + escaped(chart.name) + "</h2>\n<p>" + escaped(chart.subject.scene.summary) +
            ' ' + std::to_string(chart.subject.ticks) + " ticks.</p>\n";
    for (const ErrorKind* error : errors) {
      page += "<object type=\"image/svg+xml\" data=\"data:image/svg+xml," +
              percent_encoded(svgs[next++]) + "\"></object>\n" + front_table(chart, *error);
    }
  }
  return page + "</html>\n";
}

}  // namespace cycloid::accuracy
