#include "models/formats/mjcf_compile.h"

#include <array>
#include <cstring>
#include <mutex>
#include <stdexcept>
namespace delassus {
namespace {

std::mutex& one_at_a_time() {
  static std::mutex m;
  return m;
}

thread_local std::vector<std::string>* heard = nullptr;

/// MuJoCo ends the process after a fatal error unless its handler does not come back.
[[noreturn]] void on_error(const char* text) { throw std::runtime_error(text); }

void on_warning(const char* text) {
  if (heard != nullptr) heard->emplace_back(text);
}

/// Handlers of this file for as long as it lives; the former ones afterwards.
class Handlers {
 public:
  explicit Handlers(std::vector<std::string>& warnings) : lock_(one_at_a_time()), error_(mju_user_error), warning_(mju_user_warning) {
    heard = &warnings;
    mju_user_error = on_error;
    mju_user_warning = on_warning;
  }
  ~Handlers() {
    mju_user_error = error_;
    mju_user_warning = warning_;
    heard = nullptr;
  }
  Handlers(const Handlers&) = delete;
  Handlers& operator=(const Handlers&) = delete;

 private:
  std::lock_guard<std::mutex> lock_;
  void (*error_)(const char*);
  void (*warning_)(const char*);
};

/// What MuJoCo said, on one line.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

struct DeleteFiles {
  void operator()(mjVFS* files) const {
    mj_deleteVFS(files);
    delete files;
  }
};

/// `text` under the name of the file, in memory.
std::unique_ptr<mjVFS, DeleteFiles> in_memory(const std::string& file, const std::string& text) {
  std::unique_ptr<mjVFS, DeleteFiles> files(new mjVFS);
  mj_defaultVFS(files.get());
  if (text.empty() || mj_makeEmptyFileVFS(files.get(), file.c_str(), static_cast<int>(text.size())) != 0)
    throw std::runtime_error("MuJoCo cannot hold a file of " + std::to_string(text.size()) + " bytes");
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), file.c_str())], text.data(), text.size());
  return files;
}

/// Compiles the file on disk, or `text` in its place. @throws std::runtime_error with MuJoCo's message.
void compile(const std::string& file, const std::string* text, CompiledMjcf& out) {
  std::array<char, 1000> said{};
  std::vector<std::string> warnings;
  try {
    const Handlers handlers(warnings);
    const auto files = text == nullptr ? nullptr : in_memory(file, *text);
    out.model.reset(mj_loadXML(file.c_str(), files.get(), said.data(), static_cast<int>(said.size())));
  } catch (const std::exception& e) {
    throw std::runtime_error(one_line(e.what()));
  }
  const std::string message = one_line(said.data());
  if (!out.model) throw std::runtime_error(message);
  out.warnings = std::move(warnings);
  if (!message.empty()) out.warnings.push_back(message);
}

}  // namespace

CompiledMjcf compile_mjcf(const std::string& file) {
  CompiledMjcf out;
  const std::string accepted = "a file that MuJoCo " + std::string(mj_versionString()) + " compiles; correct what it says, or give the robot as URDF";
  MjcfXml xml(file);
  std::string refused;
  try {
    compile(file, nullptr, out);
  } catch (const std::runtime_error& e) {
    refused = e.what();
  }
  if (!out.model && xml.empty()) throw ModelError(file, "MuJoCo", refused, accepted);
  const MjcfSaid said = xml.said(refused);
  if (!out.model) {
    out.refused = refused;
    xml.respell_newer();
    xml.strip_missing_files();
    out.left_out = xml.left_out();
    out.fixed_inertia_lost = xml.fixed_inertia_lost();
    out.site_equalities = xml.site_equalities();
    try {
      out.text = xml.text();
      compile(file, &out.text, out);
    } catch (const std::runtime_error& e) {
      const std::string again = same_complaint(refused, e.what()) ? "" : "; without visuals, sensors, actuators and missing files: " + std::string(e.what());
      throw ModelError(file, said.element, said.text + again, said.to_do.empty() ? accepted : "finite numbers; " + said.to_do);
    }
  }
  out.full_inertia = xml.full_inertia();
  return out;
}

}  // namespace delassus
