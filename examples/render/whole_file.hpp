// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_WHOLE_FILE_HPP
#define PHIMIS_EXAMPLES_RENDER_WHOLE_FILE_HPP

#include <papers/output_folder.hpp>

#include <exception>
#include <filesystem>
#include <string>
#include <system_error>

namespace render {

/// Lets make(path) write a file under another name, then gives it its own: it appears whole or not at all.
///
/// Errors papers::cannot_run that names the file and says what make threw.
template <class Make>
void write_whole(const std::filesystem::path& file, const Make& make) {
  const std::filesystem::path unfinished = file.parent_path() / ('.' + file.filename().string() + ".unfinished");
  try {
    make(unfinished);
    std::filesystem::rename(unfinished, file);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw papers::cannot_run("cannot write " + file.string() + ": " + error.what());
  }
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_WHOLE_FILE_HPP
