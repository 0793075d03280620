#pragma once

#include <limits>
#include <span>

#include "engine/deform/cage.h"

namespace zoe {

enum class SchemaKind {
    kAny,
    kBool,
    kString,
    kStrings,
    kOneOf,
    kNumber,
    kNumbers,
    kInteger,
    kIndex,
    kIndices,
    kIndexMap,
    kIndexMaps,
    kObject,
    kObjects,
    kExtensions,
    kExtras,
};

/// One member of a JSON object that the reader looks at.
struct SchemaMember {
    const char* name;
    SchemaKind kind;
    const char* of = "";                         ///< What an index counts; the words of kOneOf.
    std::span<const SchemaMember> members = {};  ///< Of objects.
    double lo = 0.0, hi = 0.0;                   ///< Of the number, or of an array's length.
    bool is_required = false;
};

// Shorthand, so that the tables below read like the specification's.
namespace schema {

inline constexpr double kFloatMax = std::numeric_limits<float>::max();
/// Caps on what one file may list: a few bytes of JSON make hundreds of bytes of objects.
inline constexpr double kMany = 1 << 20, kSome = 1 << 16, kIntMax = 2147483647.0, kBytesMax = 1099511627776.0;

using Members = std::span<const SchemaMember>;
constexpr SchemaMember boolean(const char* name) {
    return {name, SchemaKind::kBool};
}
constexpr SchemaMember string(const char* name) {
    return {name, SchemaKind::kString};
}
constexpr SchemaMember strings(const char* name) {
    return {name, SchemaKind::kStrings, "", {}, 0, kSome};
}
constexpr SchemaMember one_of(const char* name, const char* words) {
    return {name, SchemaKind::kOneOf, words};
}
constexpr SchemaMember number(const char* name, double lo = -kFloatMax, double hi = kFloatMax) {
    return {name, SchemaKind::kNumber, "", {}, lo, hi};
}
constexpr SchemaMember numbers(const char* name, double lo, double hi) {
    return {name, SchemaKind::kNumbers, "", {}, lo, hi};
}
constexpr SchemaMember integer(const char* name, double lo, double hi) {
    return {name, SchemaKind::kInteger, "", {}, lo, hi};
}
constexpr SchemaMember index(const char* name, const char* of) {
    return {name, SchemaKind::kIndex, of};
}
constexpr SchemaMember indices(const char* name, const char* of, double lo = 0) {
    return {name, SchemaKind::kIndices, of, {}, lo, kMany};
}
constexpr SchemaMember index_map(const char* name) {
    return {name, SchemaKind::kIndexMap, "accessors"};
}
constexpr SchemaMember index_maps(const char* name) {
    return {name, SchemaKind::kIndexMaps, "accessors", {}, 0, kSome};
}
constexpr SchemaMember object(const char* name, Members members) {
    return {name, SchemaKind::kObject, "", members};
}
constexpr SchemaMember objects(const char* name, Members members, double hi = kSome) {
    return {name, SchemaKind::kObjects, "", members, 0, hi};
}
constexpr SchemaMember extensions(Members members) {
    return {"extensions", SchemaKind::kExtensions, "", members};
}
constexpr SchemaMember required(SchemaMember member) {
    member.is_required = true;
    return member;
}

inline constexpr SchemaMember kAsset[] = {required(string("version")), string("minVersion")};

inline constexpr SchemaMember kBuffer[] = {required(integer("byteLength", 0, kBytesMax)), string("uri")};
inline constexpr SchemaMember kBufferView[] = {
    required(index("buffer", "buffers")),
    required(integer("byteLength", 0, kBytesMax)),
    integer("byteOffset", 0, kBytesMax),
    integer("byteStride", 0, kIntMax),
};
inline constexpr SchemaMember kSparseIndices[] = {required(index("bufferView", "bufferViews")),
                                                  required(integer("componentType", 0, kIntMax)),
                                                  integer("byteOffset", 0, kIntMax)};
inline constexpr SchemaMember kSparseValues[] = {required(index("bufferView", "bufferViews")),
                                                 integer("byteOffset", 0, kIntMax)};
inline constexpr SchemaMember kSparse[] = {required(integer("count", 0, kIntMax)),
                                           required(object("indices", kSparseIndices)),
                                           required(object("values", kSparseValues))};
inline constexpr SchemaMember kAccessor[] = {
    index("bufferView", "bufferViews"),
    required(integer("componentType", 5120, 5126)),
    required(integer("count", 0, kIntMax)),
    required(one_of("type", "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4")),
    integer("byteOffset", 0, kBytesMax),
    boolean("normalized"),
    object("sparse", kSparse),
};

inline constexpr SchemaMember kPrimitiveExtensions[] = {object("FB_ngon_encoding", {})};
inline constexpr SchemaMember kPrimitive[] = {required(index_map("attributes")),
                                              index("indices", "accessors"),
                                              index("material", "materials"),
                                              integer("mode", 0, 6),
                                              index_maps("targets"),
                                              extensions(kPrimitiveExtensions)};
inline constexpr SchemaMember kSubdivision[] = {one_of("scheme", "catmull-clark loop"),
                                                integer("level", 1, kMaxSubdivisionLevel),
                                                number("pixels"),
                                                one_of("boundary", "none edge edge-and-corner"),
                                                {"creases", SchemaKind::kAny},
                                                {"corners", SchemaKind::kAny}};
inline constexpr SchemaMember kMeshExtras[] = {object("subdivision", kSubdivision)};
inline constexpr SchemaMember kMesh[] = {string("name"), required(objects("primitives", kPrimitive, kMany)),
                                         numbers("weights", 0, kSome),
                                         SchemaMember{"extras", SchemaKind::kExtras, "", kMeshExtras}};

inline constexpr SchemaMember kInstancing[] = {required(index_map("attributes"))};
inline constexpr SchemaMember kNodeLight[] = {required(index("light", "lights"))};
inline constexpr SchemaMember kNodeExtensions[] = {object("KHR_lights_punctual", kNodeLight),
                                                   object("EXT_mesh_gpu_instancing", kInstancing)};
inline constexpr SchemaMember kSequence[] = {required(indices("meshes", "meshes", 1)), number("fps")};
inline constexpr SchemaMember kNodeExtras[] = {{"motion", SchemaKind::kAny}, object("mesh_sequence", kSequence)};
inline constexpr SchemaMember kNode[] = {
    string("name"),
    index("camera", "cameras"),
    indices("children", "nodes"),
    index("mesh", "meshes"),
    index("skin", "skins"),
    numbers("matrix", 16, 16),
    numbers("rotation", 4, 4),
    numbers("scale", 3, 3),
    numbers("translation", 3, 3),
    numbers("weights", 0, kSome),
    extensions(kNodeExtensions),
    {"extras", SchemaKind::kExtras, "", kNodeExtras},
};
inline constexpr SchemaMember kScene[] = {string("name"), indices("nodes", "nodes")};
inline constexpr SchemaMember kSkinExtras[] = {{"skinning", SchemaKind::kAny}};
inline constexpr SchemaMember kSkin[] = {string("name"),
                                         required(indices("joints", "nodes", 1)),
                                         index("inverseBindMatrices", "accessors"),
                                         index("skeleton", "nodes"),
                                         {"extras", SchemaKind::kExtras, "", kSkinExtras}};

inline constexpr SchemaMember kPerspective[] = {required(number("yfov")), required(number("znear")), number("zfar"),
                                                number("aspectRatio")};
inline constexpr SchemaMember kOrthographic[] = {required(number("xmag")), required(number("ymag")),
                                                 required(number("zfar")), required(number("znear"))};
inline constexpr SchemaMember kCameraExtras[] = {{"shutter", SchemaKind::kAny}};
inline constexpr SchemaMember kCamera[] = {string("name"), required(one_of("type", "perspective orthographic")),
                                           object("perspective", kPerspective), object("orthographic", kOrthographic),
                                           SchemaMember{"extras", SchemaKind::kExtras, "", kCameraExtras}};
inline constexpr SchemaMember kSpot[] = {number("innerConeAngle"), number("outerConeAngle")};
inline constexpr SchemaMember kLight[] = {string("name"),         required(one_of("type", "directional point spot")),
                                          numbers("color", 3, 3), number("intensity"),
                                          number("range"),        object("spot", kSpot)};
inline constexpr SchemaMember kLights[] = {required(objects("lights", kLight))};
inline constexpr SchemaMember kRootExtensions[] = {object("KHR_lights_punctual", kLights)};

inline constexpr SchemaMember kTransform[] = {numbers("offset", 2, 2), number("rotation"), numbers("scale", 2, 2),
                                              integer("texCoord", 0, kIntMax)};
inline constexpr SchemaMember kTextureExtensions[] = {object("KHR_texture_transform", kTransform)};
inline constexpr SchemaMember kTextureInfo[] = {required(index("index", "textures")), integer("texCoord", 0, kIntMax),
                                                extensions(kTextureExtensions)};
inline constexpr SchemaMember kPbr[] = {numbers("baseColorFactor", 4, 4), object("baseColorTexture", kTextureInfo),
                                        number("metallicFactor"), number("roughnessFactor"),
                                        object("metallicRoughnessTexture", kTextureInfo)};
inline constexpr SchemaMember kNormalTextureInfo[] = {required(index("index", "textures")), integer("texCoord", 0, kIntMax),
                                                      number("scale"), extensions(kTextureExtensions)};
inline constexpr SchemaMember kEmissiveStrength[] = {number("emissiveStrength")};
inline constexpr SchemaMember kIor[] = {number("ior", 0)};
inline constexpr SchemaMember kSpecular[] = {number("specularFactor"), object("specularTexture", kTextureInfo),
                                             numbers("specularColorFactor", 3, 3),
                                             object("specularColorTexture", kTextureInfo)};
inline constexpr SchemaMember kTransmission[] = {number("transmissionFactor"), object("transmissionTexture", kTextureInfo)};
inline constexpr SchemaMember kVolume[] = {number("thicknessFactor"), object("thicknessTexture", kTextureInfo),
                                           number("attenuationDistance"), numbers("attenuationColor", 3, 3)};
inline constexpr SchemaMember kClearcoat[] = {
    number("clearcoatFactor"), object("clearcoatTexture", kTextureInfo), number("clearcoatRoughnessFactor"),
    object("clearcoatRoughnessTexture", kTextureInfo), object("clearcoatNormalTexture", kNormalTextureInfo)};
inline constexpr SchemaMember kSheen[] = {numbers("sheenColorFactor", 3, 3), object("sheenColorTexture", kTextureInfo),
                                          number("sheenRoughnessFactor"), object("sheenRoughnessTexture", kTextureInfo)};
inline constexpr SchemaMember kMaterialExtensions[] = {object("KHR_materials_unlit", {}),
                                                       object("KHR_materials_emissive_strength", kEmissiveStrength),
                                                       object("KHR_materials_ior", kIor),
                                                       object("KHR_materials_specular", kSpecular),
                                                       object("KHR_materials_transmission", kTransmission),
                                                       object("KHR_materials_volume", kVolume),
                                                       object("KHR_materials_clearcoat", kClearcoat),
                                                       object("KHR_materials_sheen", kSheen)};
inline constexpr SchemaMember kMaterial[] = {
    string("name"),
    object("pbrMetallicRoughness", kPbr),
    object("normalTexture", kNormalTextureInfo),
    object("occlusionTexture", kTextureInfo),
    object("emissiveTexture", kTextureInfo),
    numbers("emissiveFactor", 3, 3),
    one_of("alphaMode", "OPAQUE MASK BLEND"),
    number("alphaCutoff"),
    boolean("doubleSided"),
    extensions(kMaterialExtensions),
};
inline constexpr SchemaMember kTexture[] = {index("sampler", "samplers"), index("source", "images"), extensions({})};
inline constexpr SchemaMember kImage[] = {string("name"), string("uri"), string("mimeType"),
                                          index("bufferView", "bufferViews")};
inline constexpr SchemaMember kTextureSampler[] = {integer("magFilter", 0, kIntMax), integer("minFilter", 0, kIntMax),
                                                   integer("wrapS", 0, kIntMax), integer("wrapT", 0, kIntMax)};

inline constexpr SchemaMember kTarget[] = {index("node", "nodes"), required(string("path")), extensions({})};
inline constexpr SchemaMember kChannel[] = {required(integer("sampler", 0, kIntMax)), required(object("target", kTarget))};
inline constexpr SchemaMember kSampler[] = {required(index("input", "accessors")), required(index("output", "accessors")),
                                            one_of("interpolation", "LINEAR STEP CUBICSPLINE")};
inline constexpr SchemaMember kAnimation[] = {string("name"), required(objects("channels", kChannel, kMany)),
                                              required(objects("samplers", kSampler, kMany))};

}  // namespace schema

inline constexpr SchemaMember kSchemaRoot[] = {
    schema::required(schema::object("asset", schema::kAsset)),
    schema::strings("extensionsUsed"),
    schema::strings("extensionsRequired"),
    schema::objects("buffers", schema::kBuffer),
    schema::objects("bufferViews", schema::kBufferView, schema::kMany),
    schema::objects("accessors", schema::kAccessor, schema::kMany),
    schema::objects("meshes", schema::kMesh, schema::kMany),
    schema::objects("nodes", schema::kNode, schema::kMany),
    schema::objects("scenes", schema::kScene),
    schema::index("scene", "scenes"),
    schema::objects("skins", schema::kSkin),
    schema::objects("cameras", schema::kCamera),
    schema::objects("materials", schema::kMaterial),
    schema::objects("textures", schema::kTexture),
    schema::objects("images", schema::kImage),
    schema::objects("samplers", schema::kTextureSampler),
    schema::objects("animations", schema::kAnimation),
    schema::extensions(schema::kRootExtensions),
};

}  // namespace zoe
