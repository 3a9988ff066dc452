// VTK's XML PolyData (.vtp) with raw appended arrays: one vertex a particle, sized for glyphs by the array radius.
#include <array>
#include <cstdint>

#include "exporters/document.hpp"

namespace packmpi::exporters::vtk {
namespace {

using Row = std::function<void(Text&, const Outgoing&)>;

/// One array of the file.
struct Array {
  const char* name;
  const char* type;
  std::int64_t components, bytes;  // of one component
  Row row;
};

Array vector(const char* name, Vec3 pack::ParticleRow::*member) {
  return {name, "Float64", 3, 8, [member](Text& out, const Outgoing& p) { append_raw(out, p.row.*member); }};
}

template <class T>
Array scalar(const char* name, const char* type, T pack::ParticleRow::*member) {
  return {name, type, 1, sizeof(T), [member](Text& out, const Outgoing& p) { append_raw(out, p.row.*member); }};
}

/// Where the arrays stand in the XML, in the order of the bytes: points, particle data, vertices.
std::vector<Array> arrays(bool rotation, bool mixture) {
  std::vector<Array> all;
  all.push_back(vector("Points", &pack::ParticleRow::position));
  all.push_back(scalar("radius", "Float64", &pack::ParticleRow::radius));
  all.push_back(scalar("id", "Int64", &pack::ParticleRow::id));
  all.push_back(vector("velocity", &pack::ParticleRow::velocity));
  if (rotation) all.push_back(vector("spin", &pack::ParticleRow::spin));
  all.push_back(scalar("layer", "Int32", &pack::ParticleRow::layer));
  all.push_back(scalar("contacts", "Int32", &pack::ParticleRow::contacts));
  if (mixture) all.push_back(scalar("component", "Int32", &pack::ParticleRow::component));
  all.push_back({"connectivity", "Int64", 1, 8, [](Text& out, const Outgoing& p) { append_raw(out, p.index); }});
  all.push_back({"offsets", "Int64", 1, 8, [](Text& out, const Outgoing& p) { append_raw(out, p.index + 1); }});
  return all;
}

/// A comment of XML may have no "--" in it; "<" begins a tag.
std::string harmless(std::string text) {
  char before = '\0';
  for (char& c : text) {
    if ((c == '-' && before == '-') || c == '<' || c == '>' || c == '&') c = '_';
    before = c;
  }
  return text;
}

std::string xml(const Specimen& s, const std::vector<Array>& all) {
  std::string text = "<?xml version=\"1.0\"?>\n";
  for (const std::string& line : header_lines(s)) text += "<!-- " + harmless(line) + " -->\n";
  text += fmt::format(
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n",
      s.count);
  std::int64_t offset = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k == 0) text += "<Points>\n";
    if (k == 1) text += "</Points>\n<PointData Scalars=\"radius\">\n";
    if (k + 2 == all.size()) text += "</PointData>\n<Verts>\n";
    text += fmt::format(
        "<DataArray Name=\"{}\" type=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        all[k].name, all[k].type, all[k].components, offset);
    offset += 8 + s.count * all[k].components * all[k].bytes;
  }
  return text + "</Verts>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
}

}  // namespace

Document make(const Specimen& s) {
  const std::vector<Array> all = arrays(s.rotation, s.scene.features.mixture);
  Document document;
  std::string head = xml(s, all);
  for (const Array& array : all) {
    Text size;
    append_raw(size, static_cast<std::uint64_t>(s.count * array.components * array.bytes));
    head.append(size.data(), size.size());
    document.sections.push_back({head, array.row});
    head.clear();
  }
  document.tail = "\n</AppendedData>\n</VTKFile>\n";
  return document;
}

}  // namespace packmpi::exporters::vtk
