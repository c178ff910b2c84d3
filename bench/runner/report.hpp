#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "bench/runner/measure.hpp"

namespace cycloid::bench {

/// A line for each engine, for people who watch.
void print_result(const SceneResult& result);

/// A row for each scene and engine. @returns "" or why the file could not be written.
std::string write_csv(const std::vector<SceneResult>& results, const std::string& file);

/// The tables of docs/performance.md: a row for each scene, three columns for each engine; a table
/// for each set of engines.
std::string markdown_tables(const std::vector<SceneResult>& results);

/// "AMD EPYC, 2 processors, GCC 12.2.0, 2026-11-21"
std::string machine_text();

/// `text` between the lines "<!-- begin NAME -->" and "<!-- end NAME -->" of a file, in place of
/// what stood there. @returns "" or why not; then the file is as it was.
std::string replace_section(const std::string& file, const std::string& name,
                            const std::string& text);

}  // namespace cycloid::bench
