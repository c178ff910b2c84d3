#pragma once

#include <string>
#include <system_error>
#include <vector>

namespace cycloid::cli {

/// What a path names; all false where it names nothing, or nothing that this user may look at.
struct PathKind {
  bool exists = false;
  bool is_folder = false;
  bool is_file = false;    ///< A regular one; links are followed.
  bool is_device = false;  ///< One that gives characters, maybe without end.
};
PathKind kind_of(const std::string& path);

/// The regular files anywhere in a folder whose name ends so, sorted, with '/' between the parts.
/// Folders behind links are not entered. With what cannot be looked into, for who reads it to say
/// why: folders, and links of that name that lead nowhere.
std::vector<std::string> files_below(const std::string& folder, const std::string& suffix);

/// Puts a file in the place of another, at once; with the mode of that where there is one, but for
/// without <filesystem>.
/// @returns why it could not.
std::error_code replace_file(const std::string& by, const std::string& file);

/// Where a link leads, through all behind it; the path itself where it names none. Those that the
/// system keeps for open files stay: what they lead to need not have a name.
std::string behind_links(const std::string& path);
/// Whether the system keeps what is open under this name: "/proc/self/fd/1".
bool is_open_file(const std::string& path);

/// Whether both name one regular file, or would if it were there.
bool same_file(const std::string& a, const std::string& b);

/// How a file names another: the path from the folder of `file`, with '/' between the parts, and an
/// absolute one where there is no way. Without <filesystem> the path as it is.
std::string path_from(const std::string& file, const std::string& path);
/// What `path_from` made, as a path from the current folder again.
std::string path_to(const std::string& file, const std::string& name);

}  // namespace cycloid::cli
