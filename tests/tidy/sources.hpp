#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace cycloid::tidy {

/// One line of a source file of this repository.
struct Line {
  std::string file;  ///< Relative to the root: "solver/step.cpp".
  int number = 0;
  std::string text;
};

inline std::vector<Line> read_lines(const std::string& file) {
  std::ifstream stream(std::string(CYCLOID_SOURCE_DIR "/") + file);
  std::vector<Line> lines;
  for (std::string text; std::getline(stream, text);)
    lines.push_back({file, static_cast<int>(lines.size()) + 1, text});
  return lines;
}

/// Files of the tree with one of these endings, sorted, without what is built.
inline std::vector<std::string> files_with(const std::vector<std::string>& endings) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  const fs::path root = CYCLOID_SOURCE_DIR;
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::end(entry); ++entry) {
    const std::string name = entry->path().filename();
    if (entry->is_directory() && (name == "build" || name == ".git" || name == "install-prefix"))
      entry.disable_recursion_pending();
    if (!entry->is_regular_file()) continue;
    for (const std::string& ending : endings)
      if (name.ends_with(ending)) files.push_back(entry->path().lexically_relative(root));
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The code of a line: without comments and without what stands in quotes.
inline std::string code_of(const std::string& text) {
  std::string code;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!quoted && text.compare(i, 2, "//") == 0) break;
    const bool quote = text[i] == '"' && (i == 0 || text[i - 1] != '\\');
    if (quote) quoted = !quoted;
    if (!quoted && !quote) code += text[i];
  }
  return code;
}

}  // namespace cycloid::tidy
