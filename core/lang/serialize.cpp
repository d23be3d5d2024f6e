#include "core/lang/serialize.h"

#include "core/base/archive.h"

namespace aerosol {

template <class A>
static void describe(A& archive, SourceLocation& l) {
  archive(l.file, l.line, l.column);
}

namespace lang {

/// Structures do not occur in programs, so a type is its base and its length.
template <class A>
static void describe(A& archive, Type& t) {
  archive(t.base, t.closure, t.arrayLength);
}
template <class A>
static void describe(A& archive, Variable& v) {
  archive(v.name, v.type, v.storage, v.location, v.parameter, v.global, v.value);
}
template <class A>
static void describe(A& archive, Instruction& i) {
  archive(i.op, i.testsLast, i.quiet, i.result, i.location, i.scopeId, i.site, i.function, i.arguments, i.bodies);
}
template <class A>
static void describe(A& archive, FunctionUse& f) {
  archive(f.symbol, f.pure, f.outputs, f.host, f.traits);
}
template <class A>
static void describe(A& archive, ClosureLayer& l) {
  archive(l.top, l.weight);
}
template <class A>
static void describe(A& archive, ClosureSite& s) {
  archive(s.closure, s.location, s.parameterTypes, s.parameterNames, s.layers);
}
template <class A>
static void describe(A& archive, MetadataValue& m) {
  archive(m.name, m.type, m.value);
}
template <class A>
static void describe(A& archive, Parameter& p) {
  archive(p.name, p.type, p.isOutput, p.hasConstantDefault, p.defaultValue, p.metadata, p.location, p.variable, p.isSet,
          p.isConnected);
}
template <class A>
static void describe(A& archive, Output& o) {
  archive(o.kind, o.index, o.subIndex, o.variable);
}
template <class A>
static void describe(A& archive, Program& p) {
  archive(p.kind, p.name, p.metadata, p.parameters, p.variables, p.functions, p.closureSites, p.locations, p.body, p.ci,
          p.outputs);
}

std::string serialise(const Program& program) {
  ArchiveWriter writer;
  std::uint32_t version = programFormatVersion;
  Program copy = program;
  writer(version, copy);
  return writer.take();
}

std::optional<Program> deserialiseProgram(std::string_view bytes) {
  ArchiveReader reader(bytes);
  std::uint32_t version = 0;
  reader(version);
  if (version != programFormatVersion) return {};
  Program program;
  reader(program);
  if (!reader.succeeded()) return {};
  return program;
}

}  // namespace lang
}  // namespace aerosol
