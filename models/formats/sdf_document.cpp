#include "models/formats/sdf_document.h"

#include "algorithms/errors/status.h"

#ifdef DELASSUS_SDFORMAT

#include <filesystem>
#include <set>

#include <sdf/sdf.hh>

#include <Eigen/Geometry>

#include "algorithms/errors/message.h"
#include "models/shapes/mesh.h"
#include "models/formats/sdf_counts.h"
#include "models/formats/sdf_said.h"
#include "models/formats/sdf_text.h"
#include "models/formats/xml_lines.h"

namespace delassus {
namespace {

namespace fs = std::filesystem;
using V3 = Vector3<double>;

V3 vector(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

Pose<double> pose_of(const ignition::math::Pose3d& p) {
  return {Eigen::Quaterniond(p.Rot().W(), p.Rot().X(), p.Rot().Y(), p.Rot().Z()).normalized().toRotationMatrix(), vector(p.Pos())};
}

class SdfReader {
 public:
  SdfReader(const RobotOptions& options, Findings& findings) : options_(options), findings_(findings), lines_(options.file) {}

  SdfDocument run() {
    tinyxml2::XMLDocument document;
    if (document.LoadFile(options_.file.c_str()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) fail("file", "is no XML", "an SDF file; correct what an XML checker says of it");
    check_sdf_numbers(options_.file, *document.RootElement());
    leave_out_of_sdf(*document.RootElement());
    check_sdf_words(options_.file, *document.RootElement());
    check_counts(options_.file, *document.RootElement(), findings_);
    automatic_ = links_of_automatic_inertia(*document.RootElement());
    const std::string text = text_on_its_lines(document);
    const SdfConsole console;
    load(text, console, *document.RootElement());
    for (const std::string& printed : console.messages()) {
      const SdfSaid said = sdf_said(printed);
      findings_.warn("said by libsdformat", options_.file, said.element, said.text, said.accepted);
    }
    std::vector<const sdf::Model*> models;
    if (root_.Model() != nullptr) models.push_back(root_.Model());
    for (uint64_t w = 0; w < root_.WorldCount(); ++w)
      for (uint64_t k = 0; k < root_.WorldByIndex(w)->ModelCount(); ++k) models.push_back(root_.WorldByIndex(w)->ModelByIndex(k));
    for (const sdf::Model* m : models) add_model(*m, {}, models.size() > 1 ? m->Name() + "::" : "", false);
    if (out_.links.empty()) fail("<sdf> (line " + std::to_string(document.RootElement()->GetLineNum()) + ")", "has no link", "a <model>, or a <world> with models; give mesh_path: [folders] for models that it includes");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(options_.file, element, problem, accepted);
  }

  void load(const std::string& text, const SdfConsole& console, const tinyxml2::XMLElement& document) {
    sdf::ParserConfig config;
    config.SetFindCallback([&](const std::string& uri) {
      std::string tried;
      std::string found = find_mesh(uri, options_.file, options_.mesh_path, tried);
      if (found.empty()) found = folder_of(uri);
      return found;
    });
    sdf::Errors errors, fatal;
    try {
      errors = root_.LoadSdfString(text, config);
    } catch (const std::exception& e) {
      fatal.emplace_back(sdf::ErrorCode::NONE, e.what());
    }
    for (const sdf::Error& e : errors) {
      if (e.Code() == sdf::ErrorCode::LINK_INERTIA_INVALID) continue;  // judged like those of all readers
      if (e.Code() == sdf::ErrorCode::URI_LOOKUP || e.Code() == sdf::ErrorCode::URI_INVALID)
        findings_.warn("include not found", options_.file, "<include>" + in_line(e.LineNumber().value_or(0)), e.Message(), "what it holds is not in the model; mesh_path: [folders] in the scene's robot entry says where models are");
      else fatal.push_back(e);
    }
    if (fatal.empty()) return;
    const SdfSaid said = sdf_said(fatal, console.messages(), lines_, document);
    fail(said.element, said.text, "an SDF file that libsdformat " + std::string(SDF_VERSION_FULL) + " reads; correct what it says, or give the robot as URDF");
  }

  /// The folder a model://name stands for, "" when there is none.
  [[nodiscard]] std::string folder_of(const std::string& uri) const {
    for (const char* scheme : {"model://", "package://"}) {
      if (uri.rfind(scheme, 0) != 0) continue;
      const std::string name = uri.substr(std::string_view(scheme).size());
      std::string tried;
      const std::string config = find_mesh(uri + "/model.config", options_.file, options_.mesh_path, tried);
      if (!name.empty() && !config.empty()) return fs::path(config).parent_path().string();
    }
    std::error_code error;
    const fs::path beside = fs::path(options_.file).parent_path() / uri;
    return uri.find("://") == std::string::npos && fs::exists(beside, error) ? beside.string() : "";
  }

  template <class Semantic> Pose<double> resolve(const Semantic& s, const std::string& in, const std::string& element) const {
    ignition::math::Pose3d out;
    const sdf::Errors errors = s.Resolve(out, in);
    if (!errors.empty()) fail(element, "libsdformat: " + errors[0].Message(), "a pose that can be resolved; check relative_to");
    if (!out.IsFinite()) fail(element, "its pose, (" + numbers_text(vector(out.Pos())) + ") m, is not finite", "finite numbers [m, rad]; correct <pose>");
    return pose_of(out);
  }

  void add_model(const sdf::Model& m, const Pose<double>& outer, const std::string& scope, bool fixed) {
    const std::string element = lines_.element("model", m.Name());
    const Pose<double> X = outer * resolve(m.SemanticPose(), "", element);
    fixed = fixed || m.Static();
    for (uint64_t k = 0; k < m.LinkCount(); ++k) add_link(*m.LinkByIndex(k), X, scope, fixed);
    for (uint64_t k = 0; k < m.ModelCount(); ++k) add_model(*m.ModelByIndex(k), X, scope + m.ModelByIndex(k)->Name() + "::", fixed);
    for (uint64_t k = 0; k < m.JointCount(); ++k) add_joint(*m.JointByIndex(k), X, scope);
  }

  void add_link(const sdf::Link& l, const Pose<double>& model, const std::string& scope, bool fixed) {
    SdfDocument::Link out;
    out.name = scope + l.Name();
    out.line = lines_.line("link", out.name);
    const std::string element = out.element = lines_.element("link", out.name);
    out.pose = model * resolve(l.SemanticPose(), "__model__", element);
    out.fixed = fixed;
    out.has_inertial = l.Element() != nullptr && l.Element()->HasElement("inertial");
    out.mass_given = out.has_inertial && l.Element()->GetElement("inertial")->HasElement("mass");
    out.inertia_asked_of_shapes = out.line > 0 && automatic_.count(out.line) > 0;
    out.mass = l.Inertial().MassMatrix().Mass();
    out.centre = pose_of(l.Inertial().Pose());
    const ignition::math::Matrix3d I = l.Inertial().MassMatrix().Moi();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.inertia(i, j) = I(i, j);
    for (uint64_t k = 0; k < l.CollisionCount(); ++k) add_collision(*l.CollisionByIndex(k), element, out);
    out_.links.push_back(std::move(out));
  }

  void add_collision(const sdf::Collision& c, const std::string& link, SdfDocument::Link& out) {
    const std::string element = link + " <collision name=" + in_quotes(c.Name()) + ">";
    const sdf::Geometry& g = *c.Geom();
    Shape s;
    s.placement = resolve(c.SemanticPose(), "", element);
    s.friction = friction(c);
    switch (g.Type()) {
      case sdf::GeometryType::BOX: s.kind = Shape::Kind::box, s.size = vector(g.BoxShape()->Size()) / 2; break;
      case sdf::GeometryType::SPHERE: s.kind = Shape::Kind::sphere, s.size[0] = g.SphereShape()->Radius(); break;
      case sdf::GeometryType::CYLINDER: s.kind = Shape::Kind::cylinder, s.size << g.CylinderShape()->Radius(), g.CylinderShape()->Length() / 2, 0; break;
      case sdf::GeometryType::CAPSULE: s.kind = Shape::Kind::capsule, s.size << g.CapsuleShape()->Radius(), g.CapsuleShape()->Length() / 2, 0; break;
      case sdf::GeometryType::MESH: return add_mesh(*g.MeshShape(), s, element, out);
      case sdf::GeometryType::EMPTY: return;
      case sdf::GeometryType::PLANE: return left_out(element, "a plane", "ground: {z: ...} of the scene");
      case sdf::GeometryType::HEIGHTMAP: return left_out(element, "a heightmap", "boxes of the scene");
      case sdf::GeometryType::ELLIPSOID: return left_out(element, "an ellipsoid", "a sphere, capsule, box or mesh");
    }
    const bool cylinder = s.kind == Shape::Kind::cylinder;
    const Index sizes = s.kind == Shape::Kind::box ? 3 : cylinder ? 2 : 1;
    if (s.size.minCoeff() < 0) fail(element, "a size of " + number_text((s.kind == Shape::Kind::box || s.size[1] < 0 ? 2 : 1) * s.size.minCoeff()) + " m is negative", "lengths >= 0 [m]; leave the <collision> out where there is none");
    if (s.kind == Shape::Kind::capsule && s.size[1] == 0) s.kind = Shape::Kind::sphere;
    if (sizes > 1 && s.size.head(sizes).minCoeff() == 0)
      return findings_.warn("flat collision shape", options_.file, element, "a shape without volume is left out", "lengths > 0 [m]");
    out.shapes.push_back(s);
  }

  void left_out(const std::string& element, const std::string& what, const std::string& instead) {
    findings_.note(options_.file + ": " + element + ": " + what + " is left out (" + instead + ")");
  }

  void add_mesh(const sdf::Mesh& m, const Shape& s, const std::string& element, SdfDocument::Link& out) {
    Robot::Mesh mesh;
    mesh.placement = s.placement;
    mesh.scale = vector(m.Scale());
    mesh.uri = m.Uri(), mesh.part = m.Submesh();
    mesh.element = element + " <mesh>";
    mesh.friction = s.friction;
    if (!mesh.part.empty() && m.CenterSubmesh()) return left_out(element, "a centred part of a mesh", "a mesh file of its own");
    out.meshes.push_back(mesh);
  }

  /// surface/friction/ode/mu, when it is given.
  static double friction(const sdf::Collision& c) {
    sdf::ElementPtr e = c.Element();
    for (const char* name : {"surface", "friction", "ode", "mu"}) {
      if (e == nullptr || !e->HasElement(name)) return -1;
      e = e->GetElement(name);
    }
    const double mu = e->Get<double>();
    return std::isfinite(mu) && mu >= 0 ? mu : -1;
  }

  void add_joint(const sdf::Joint& j, const Pose<double>& model, const std::string& scope) {
    using Type = SdfDocument::Type;
    SdfDocument::JointRow out;
    out.name = scope + j.Name();
    const std::string element = out.element = lines_.element("joint", out.name);
    std::string parent, child;
    sdf::Errors errors = j.ResolveParentLink(parent);
    const sdf::Errors more = j.ResolveChildLink(child);
    errors.insert(errors.end(), more.begin(), more.end());
    if (!errors.empty()) fail(element, "libsdformat: " + errors[0].Message(), "two links of this model, or world; correct <parent> and <child>");
    out.parent = parent == "world" ? parent : scope + parent;
    out.child = child == "world" ? child : scope + child;
    out.pose = model * resolve(j.SemanticPose(), "__model__", element);
    switch (j.Type()) {
      case sdf::JointType::BALL: out.type = Type::ball; break;
      case sdf::JointType::CONTINUOUS: out.type = Type::continuous; break;
      case sdf::JointType::FIXED: out.type = Type::fixed; break;
      case sdf::JointType::GEARBOX: out.type = Type::gearbox; break;
      case sdf::JointType::PRISMATIC: out.type = Type::prismatic; break;
      case sdf::JointType::REVOLUTE: out.type = Type::revolute; break;
      case sdf::JointType::REVOLUTE2: out.type = Type::revolute2; break;
      case sdf::JointType::SCREW: out.type = Type::screw; break;
      case sdf::JointType::UNIVERSAL: out.type = Type::universal; break;
      case sdf::JointType::INVALID: fail(element, "its type is not known", "a joint type of SDF: revolute, prismatic, fixed, ball, universal, ...; correct <joint type>");
    }
    for (unsigned k = 0; k < 2; ++k)
      if (j.Axis(k) != nullptr) out.axes.push_back(axis(*j.Axis(k), element));
    out.thread_pitch = j.ThreadPitch();
    if (j.Element() != nullptr && j.Element()->HasElement("gearbox_ratio")) out.ratio = j.Element()->Get<double>("gearbox_ratio");
    if (j.Element() != nullptr && j.Element()->HasElement("gearbox_reference_body")) out.reference = scope + j.Element()->Get<std::string>("gearbox_reference_body");
    out_.joints.push_back(std::move(out));
  }

  SdfDocument::Axis axis(const sdf::JointAxis& a, const std::string& element) {
    SdfDocument::Axis out;
    ignition::math::Vector3d v;
    const sdf::Errors errors = a.ResolveXyz(v);
    if (!errors.empty()) fail(element + " <axis>", "libsdformat: " + errors[0].Message(), "an axis that can be resolved; check expressed_in");
    out.direction = vector(v);
    if (!out.direction.allFinite() || out.direction.norm() == 0) fail(element + " <axis>", "(" + numbers_text(out.direction) + ") is no direction", "a vector that is not 0; give the axis, or take a fixed joint");
    out.direction.normalize();
    constexpr double unlimited = 1e16;  // SDF's own default of limits
    out.damping = a.Damping(), out.friction = a.Friction();
    out.lower = a.Lower(), out.upper = a.Upper(), out.effort = a.Effort(), out.velocity = a.MaxVelocity();
    out.range_given = std::abs(out.lower) < unlimited || std::abs(out.upper) < unlimited;
    out.effort_given = out.effort >= 0 && out.effort < unlimited, out.velocity_given = out.velocity >= 0 && out.velocity < unlimited;
    return out;
  }

  const RobotOptions& options_;
  Findings& findings_;
  XmlLines lines_;
  std::set<int> automatic_;  ///< lines of links
  sdf::Root root_;
  SdfDocument out_;
};

}  // namespace

SdfDocument read_sdf(const RobotOptions& options, Findings& findings) { return SdfReader(options, findings).run(); }

}  // namespace delassus

#else

namespace delassus {

SdfDocument read_sdf(const RobotOptions& options, Findings&) {
  throw ModelError(options.file, "<sdf>", "an SDF file cannot be read: built without libsdformat", "URDF; or install libsdformat-dev (version 12) and build again");
}

}  // namespace delassus

#endif
