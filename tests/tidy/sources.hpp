#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/places.hpp"

namespace cycloid::tidy {

/// A text file of this repository, or one made up to see a rule fail.
struct Source {
  std::string path;  ///< Relative to the root: "solver/step.cpp".
  std::vector<std::string> lines;
  std::vector<std::string> code;  ///< The lines without comments and without what is quoted.

  std::string at(std::size_t line) const { return path + ":" + std::to_string(line + 1) + ": "; }
};

/// What a rule has against a file, one text each; empty where it holds.
using Complaints = std::vector<std::string>;

inline std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The index behind the quoted text that begins at `i`, or `i` where none does. An apostrophe
/// between digits is not a quote, and the quotes of a raw string mean nothing inside it.
inline std::size_t behind_quoted(const std::string& text, std::size_t i) {
  if (text.compare(i, 2, "R\"") == 0) {
    const std::size_t open = text.find('(', i);
    if (open == std::string::npos) return text.size();
    const std::string close = ")" + text.substr(i + 2, open - i - 2) + "\"";
    const std::size_t end = text.find(close, open);
    return end == std::string::npos ? text.size() : end + close.size();
  }
  const bool within_number =
      text[i] == '\'' && i > 0 && std::isalnum(static_cast<unsigned char>(text[i - 1])) != 0;
  if ((text[i] != '"' && text[i] != '\'') || within_number) return i;
  std::size_t end = i + 1;
  while (end < text.size() && text[end] != text[i]) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

/// The index behind the comment that begins at `i`, or `i` where none does.
inline std::size_t behind_comment(const std::string& text, std::size_t i) {
  if (text.compare(i, 2, "//") == 0) return std::min(text.find('\n', i), text.size());
  if (text.compare(i, 2, "/*") != 0) return i;
  const std::size_t end = text.find("*/", i + 2);
  return end == std::string::npos ? text.size() : end + 2;
}

/// The text without comments and quoted text; every line keeps its number.
inline std::string code_of(const std::string& text) {
  std::string code;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t behind = std::max(behind_comment(text, i), behind_quoted(text, i));
    if (behind == i) {
      code += text[i++];
      continue;
    }
    code.append(static_cast<std::size_t>(std::count(&text[i], text.data() + behind, '\n')), '\n');
    i = behind;
  }
  return code;
}

inline Source make_source(const std::string& path, const std::string& text) {
  return {path, split_lines(text), split_lines(code_of(text))};
}

inline Source read_source(const std::string& path) {
  std::ifstream stream(places::source(path));
  std::ostringstream text;
  text << stream.rdbuf();
  return make_source(path, text.str());
}

/// Whether a folder or file of the root belongs to the sources: not what is built or installed,
/// nor what another tool keeps for itself.
inline bool is_ours(const std::string& top) {
  return !top.starts_with("build") && top != "install" && (top[0] != '.' || top == ".ci");
}

/// Paths of all files of the tree with one of these endings, sorted. No ending: all files.
inline std::vector<std::string> files_with(const std::vector<std::string>& endings) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  const fs::path root = places::source("");
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::end(entry); ++entry) {
    const std::string name = entry->path().filename();
    if (entry->is_directory() && ((entry.depth() == 0 && !is_ours(name)) || name == "__pycache__"))
      entry.disable_recursion_pending();
    if (!entry->is_regular_file()) continue;
    const auto ends_name = [&](const std::string& ending) { return name.ends_with(ending); };
    if (endings.empty() || std::any_of(endings.begin(), endings.end(), ends_name))
      files.push_back(entry->path().lexically_relative(root));
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Every .cpp and .hpp of the tree, read once.
inline const std::vector<Source>& sources() {
  static const std::vector<Source> all = [] {
    std::vector<Source> read;
    for (const std::string& path : files_with({".cpp", ".hpp"})) read.push_back(read_source(path));
    return read;
  }();
  return all;
}

}  // namespace cycloid::tidy
