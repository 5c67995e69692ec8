#include "models/shapes/mesh.h"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <stdexcept>

#ifdef DELASSUS_ASSIMP
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#endif

#include "algorithms/errors/message.h"
#include "models/shapes/hull.h"

namespace delassus {
namespace {

namespace fs = std::filesystem;

using V3 = Vector3<double>;

bool is_file(const fs::path& p) {
  std::error_code error;
  return fs::is_regular_file(p, error);
}

/// The folders packages may lie in, in the order of the search.
std::vector<fs::path> package_folders(const std::string& robot_file, const std::vector<std::string>& mesh_path) {
  std::vector<fs::path> out(mesh_path.begin(), mesh_path.end());
  if (const char* all = std::getenv("ROS_PACKAGE_PATH")) {
    std::string_view rest(all);
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(':'), rest.size());
      if (end > 0) out.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  std::error_code error;
  fs::path folder = fs::absolute(robot_file, error).lexically_normal().parent_path();
  for (; !folder.empty(); folder = folder.parent_path()) {
    out.push_back(folder);
    if (folder == folder.parent_path()) break;
  }
  return out;
}

/// The path after the scheme, "" for other schemes.
std::string after(const std::string& uri, std::string_view scheme) {
  return uri.rfind(scheme, 0) == 0 ? uri.substr(scheme.size()) : std::string();
}

std::string find_in_packages(const std::string& rest, const std::string& robot_file, const std::vector<std::string>& mesh_path,
                             std::string& tried) {
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos || slash == 0) {
    tried = "no package and path in it are named";
    return "";
  }
  const std::string name = rest.substr(0, slash), path = rest.substr(slash + 1);
  for (const fs::path& f : package_folders(robot_file, mesh_path)) {
    if (is_file(f / name / path)) return (f / name / path).string();
    const fs::path folder = f.has_filename() ? f : f.parent_path();  // "a/b/" as "a/b"
    if (folder.filename() == name && is_file(f / path)) return (f / path).string();
  }
  tried = "package " + in_quotes(name) + " with this file is not in mesh_path, ROS_PACKAGE_PATH or a folder above the robot's file";
  return "";
}

}  // namespace

std::string find_mesh(const std::string& uri, const std::string& robot_file, const std::vector<std::string>& mesh_path,
                      std::string& tried) {
  for (const char* scheme : {"package://", "model://"})
    if (const std::string rest = after(uri, scheme); !rest.empty()) return find_in_packages(rest, robot_file, mesh_path, tried);
  const bool local = uri.rfind("file://", 0) == 0;
  if (!local && uri.find("://") != std::string::npos) {
    tried = "only files are read";
    return "";
  }
  const fs::path path = local ? uri.substr(7) : uri;
  if (path.empty()) {
    tried = "no file is named";
    return "";
  }
  const fs::path own = path.is_absolute() ? path : fs::path(robot_file).parent_path() / path;
  if (is_file(own)) return own.string();
  tried = "there is no file " + in_quotes(own.lexically_normal().string());
  if (path.is_absolute()) return "";
  for (const std::string& f : mesh_path)
    if (is_file(fs::path(f) / path)) {
      tried.clear();
      return (fs::path(f) / path).string();
    }
  if (!mesh_path.empty()) tried += ", nor one in mesh_path";
  return "";
}

#ifndef DELASSUS_ASSIMP

bool has_mesh_files() { return false; }
std::vector<V3> mesh_points(const std::string&, const std::string&) { throw std::runtime_error("built without assimp"); }

#else

bool has_mesh_files() { return true; }

std::vector<V3> mesh_points(const std::string& file, const std::string& part) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                          aiComponent_TEXCOORDS | aiComponent_TEXTURES | aiComponent_MATERIALS);
  const aiScene* scene = importer.ReadFile(file, aiProcess_RemoveComponent);
  if (scene == nullptr || scene->mRootNode == nullptr) throw std::runtime_error(importer.GetErrorString());
  struct Visit {
    const aiNode* node;
    aiMatrix4x4 above;
    bool wanted;
  };
  std::vector<V3> out;
  std::size_t broken = 0;
  std::vector<Visit> stack{{scene->mRootNode, {}, part.empty()}};
  while (!stack.empty()) {
    const Visit v = stack.back();
    stack.pop_back();
    const aiMatrix4x4 X = v.above * v.node->mTransformation;
    const bool node_wanted = v.wanted || part == v.node->mName.C_Str();
    for (unsigned k = 0; k < v.node->mNumMeshes; ++k) {
      const aiMesh& mesh = *scene->mMeshes[v.node->mMeshes[k]];
      if (!node_wanted && part != mesh.mName.C_Str()) continue;
      for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const aiVector3D p = X * mesh.mVertices[i];
        const V3 point(p.x, p.y, p.z);
        if (point.allFinite()) out.push_back(point);
        else ++broken;
      }
    }
    for (unsigned k = 0; k < v.node->mNumChildren; ++k) stack.push_back({v.node->mChildren[k], X, node_wanted});
  }
  if (broken > 0) throw std::runtime_error(std::to_string(broken) + " of its points are not finite");
  if (out.empty()) throw std::runtime_error(part.empty() ? "it has no points" : "it has no object " + in_quotes(part));
  return out;
}

#endif

namespace {

struct Read {
  std::vector<V3> points;
  std::string problem;  // why there are none
};

/// Hulls of the meshes of one robot, with what is to be told.
class Hulls {
 public:
  Hulls(Model& model, Robot& robot, Index most, double margin, Findings& found)
      : model_(model), robot_(robot), most_(most), margin_(margin), found_(found) {}

  void run() {
    for (const Robot::Mesh& m : robot_.meshes) add(m);
    if (read_ == 0) return;
    std::string text = robot_.file + ": " + std::to_string(read_) + (read_ == 1 ? " collision mesh" : " collision meshes") + " as convex hull" + (read_ == 1 ? "" : "s");
    if (cut_count_ > 0)
      text += ", " + std::to_string(cut_count_) + " cut to " + std::to_string(most_) + " vertices: by at most " + number_text(deepest_) + " m, at " + deepest_at_;
    found_.note(std::move(text));
  }

 private:
  void warn(const std::string& kind, const Robot::Mesh& m, const std::string& problem, const std::string& advice) {
    found_.warn(kind, robot_.file, m.element, "mesh " + in_quotes(m.uri) + " " + problem, advice);
  }

  const Read& read(const std::string& file, const std::string& part) {
    const auto [it, first] = files_.try_emplace({file, part});
    if (!first) return it->second;
    try {
      it->second.points = mesh_points(file, part);
    } catch (const std::exception& e) {
      it->second.problem = e.what();
    }
    return it->second;
  }

  void add(const Robot::Mesh& m) {
    std::string tried;
    const std::string file = find_mesh(m.uri, robot_.file, robot_.mesh_path, tried);
    if (file.empty())
      return warn("mesh not found", m, "is not found: " + tried,
                  "without it this shape touches nothing; mesh_path: [folders] in the scene's robot entry says where packages are");
    const Read& r = read(file, m.part);
    if (!r.problem.empty()) return warn("mesh not read", m, "cannot be read: " + r.problem, "without it this shape touches nothing; write it anew as STL or OBJ, or give a primitive in its place");
    std::vector<V3> points;
    for (const V3& p : r.points) points.push_back(m.scale.cwiseProduct(p));
    try {
      place(m, convex_hull(points, most_));
    } catch (const std::runtime_error& e) {
      warn("mesh not read", m, std::string("has no convex hull: ") + e.what(), "without it this shape touches nothing; look for points far out, or give a primitive in its place");
    }
  }

  /// The shape's frame is put into the middle of the points.
  void place(const Robot::Mesh& m, const Hull& hull) {
    V3 low = hull.vertices.front(), high = low;
    for (const V3& p : hull.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const V3 centre = low / 2 + high / 2;
    auto points = std::make_shared<std::vector<V3>>();
    for (const V3& p : hull.vertices) points->push_back(p - centre);
    Shape s;
    s.kind = Shape::Kind::hull;
    s.size = high / 2 - low / 2;
    s.placement = m.placement * Pose<double>{Matrix3<double>::Identity(), centre};
    s.friction = m.friction;
    s.points = std::move(points);
    if (m.body == ground) robot_.standing.push_back({m.link, std::move(s)});
    else model_.bodies[static_cast<std::size_t>(m.body)].shapes.push_back(std::move(s));
    ++read_;
    if (static_cast<Index>(hull.vertices.size()) == hull.all) return;
    ++cut_count_;
    if (hull.cut > margin_)
      warn("hull cut deeply", m, "has a hull of " + std::to_string(hull.all) + " vertices; the " + std::to_string(most_) + " kept cut it by up to " + number_text(hull.cut) + " m, more than the margin of contacts, " + number_text(margin_) + " m",
           "hull_vertices: a larger number, in contacts, keeps more");
    if (hull.cut >= deepest_) deepest_ = hull.cut, deepest_at_ = m.element;
  }

  Model& model_;
  Robot& robot_;
  Index most_;
  double margin_;
  Findings& found_;
  std::map<std::pair<std::string, std::string>, Read> files_;
  Index read_ = 0, cut_count_ = 0;
  double deepest_ = 0;
  std::string deepest_at_;
};

}  // namespace

void add_hulls(Model& model, Robot& robot, Index most, double margin, Findings& found) {
  if (robot.meshes.empty()) return;
  const std::string without = has_hulls() ? "assimp" : has_mesh_files() ? "qhull" : "assimp and qhull";
  const std::string package = has_hulls() ? "libassimp-dev" : has_mesh_files() ? "libqhull-dev" : "libassimp-dev and libqhull-dev";
  if (!has_mesh_files() || !has_hulls())
    return found.warn("mesh not read", robot.file, "<mesh>",
                      std::to_string(robot.meshes.size()) + " collision meshes are not read and touch nothing: built without " + without,
                      "install " + package + " and build again, or give collision primitives");
  Hulls(model, robot, most, margin, found).run();
}

}  // namespace delassus
