// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_OUTPUT_FOLDER_HPP
#define PHIMIS_EXAMPLES_PAPERS_OUTPUT_FOLDER_HPP

#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace papers {

/// What stops a program before its work: a folder that cannot be written, a tool that is missing.
struct cannot_run : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A folder in which files appear whole or not at all: each is written under another name first.
///
/// Errors cannot_run where the folder cannot be made or a file cannot be written.
class output_folder {
 public:
  explicit output_folder(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code error;
    std::filesystem::create_directories(path_, error);
    if (error) throw cannot_run("cannot make the folder " + path_.string() + ": " + error.message());
    const std::filesystem::path probe = unfinished("probe");
    const bool writable = std::ofstream(probe).put(' ').good();
    std::filesystem::remove(probe, error);
    if (!writable) throw cannot_run("cannot write to the folder " + path_.string());
  }

  const std::filesystem::path& path() const noexcept { return path_; }

  void write(const std::string& name, const std::string& text) const {
    produce(name, [&](const std::filesystem::path& file) {
      std::ofstream out(file, std::ios::binary);
      return out.write(text.data(), static_cast<std::streamsize>(text.size())).flush().good();
    });
  }

  /// Lets `make` write a file, says whether it could, and gives the file its name.
  void produce(const std::string& name, const std::function<bool(const std::filesystem::path&)>& make) const {
    const std::filesystem::path file = unfinished(name);
    std::error_code error;
    const bool made = make(file) && std::filesystem::file_size(file, error) > 0 && !error;
    if (made) std::filesystem::rename(file, path_ / name, error);
    if (!made || error) {
      std::filesystem::remove(file, error);
      throw cannot_run("cannot write " + (path_ / name).string());
    }
  }

 private:
  std::filesystem::path unfinished(const std::string& name) const { return path_ / ('.' + name + ".unfinished"); }

  std::filesystem::path path_;
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_OUTPUT_FOLDER_HPP
