/// The C interface: for C99, and for all languages that can call C, such as Python (ctypes) and C# (P/Invoke).
///
/// No function throws, keeps what it is given, or has a state of its own: calls may run in parallel, each with a result
/// of its own.
///
/// A result (`CagecastTransfer` and the like) is zeroed by the caller before its first use. It owns the arrays that it
/// points to, until it is filled again, which uses its memory again, or freed by its function.
///
/// NULL for a mesh, a model, a template or a transfer is an error, NULL for options means the defaults.
///
/// What returns `int32_t` returns 0, or 1 after an error: then the result has an `error` and no arrays. The headers for
/// C++ say more of each function and field.
#ifndef CAGECAST_C_H
#define CAGECAST_C_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What went wrong. `code`, `argument` and `option` point to constants, and are empty where there is none.
typedef struct CagecastError {
  const char* code;      ///< As in codes.def: "indexOutOfRange"; "ok".
  const char* argument;  ///< The argument at fault: "cage", "target", "options", "model", "template", "landmarks".
  const char* option;    ///< The option at fault: "threshold", "parts.ignore".
  uint32_t at;           ///< The element at fault, or a count: codes.def says which.
  float value;           ///< The value at fault, if there is one.
  char message[512];     ///< One sentence for people in UTF-8, cut off if it is longer.
} CagecastError;

/// A mesh of triangles; NULL for what it has not. It is only read. See mesh.hpp.
typedef struct CagecastMesh {
  const float* positions;   ///< 3 per vertex; one space for cage and target.
  const uint32_t* indices;  ///< 3 per triangle, counter-clockwise seen from outside.
  const float* uvs;         ///< 2 per vertex. A target may have none.
  const uint32_t* groups;   ///< 1 per vertex: the number of its part.
  const float* poses;       ///< 3 per vertex and pose: other positions of a target's vertices.
  uint32_t vertexCount, triangleCount, poseCount;
} CagecastMesh;

/// A list of numbers.
typedef struct CagecastList {
  const uint32_t* items;
  uint32_t count;
} CagecastList;

/// What the user says of a segment.
typedef struct CagecastLock {
  uint32_t segment;
  uint8_t lock;  ///< 0 automatic, 1 keep, 2 exclude.
} CagecastLock;

/// See options.def and options.hpp. `cagecastDefaults` fills them in; NULL in place of options means those.
typedef struct CagecastOptions {
  int32_t paper;   ///< Whether single steps are those of the preset `paper`, the method as published.
  int32_t seams;   ///< 0 per vertex, 1 per corner.
  int32_t motion;  ///< Whether what `poses` show is painted as well.
  float threshold, minCovered;
  float weldTolerance, occlusionReach, pokeThrough;  ///< Shares of the target's diagonal.
  CagecastList ignore, keep, exclude;                ///< Parts of the target, by their groups.
  const CagecastLock* locks;
  uint32_t lockCount;
  const int8_t* vertexMasks;    ///< 1 per vertex of the target, or NULL: -1 never painted, 0 automatic, 1 always.
  const int8_t* triangleMasks;  ///< 1 per triangle of the target, or NULL.
} CagecastOptions;

/// A connected part of the target. See `SegmentStats`.
typedef struct CagecastSegment {
  double area, exposedArea, coveredArea;  ///< In squared units of the input.
  double score, confidence;
  uint32_t points, group;
  uint8_t culledBy;  ///< 0 not culled, 1 coverage, 2 a hole, 3 a lock, 4 it is ignored.
} CagecastSegment;

/// The result of `cagecastTransfer`. Zones are 0 cosmetic (may be painted), 1 occluded, 2 uncovered, 3 culled.
typedef struct CagecastTransfer {
  const float* uvs;                  ///< 2 per vertex, in the cage's texture.
  const float* cornerUvs;            ///< 2 per index with `seams` 1, else NULL.
  const uint8_t* zones;              ///< 1 per vertex.
  const uint8_t* cosmeticTriangles;  ///< 1 per triangle: 1 if it may be painted.
  const uint32_t* cageTriangles;     ///< 1 per vertex: the nearest triangle of the cage.
  const float* distances;            ///< 1 per vertex: the distance to it.
  const uint32_t* segments;          ///< 1 per vertex: its segment.
  const CagecastSegment* segmentStats;
  uint32_t vertexCount, triangleCount, segmentCount;
  CagecastError error;
  void* memory;  ///< The library's own.
} CagecastTransfer;

/// A mesh whose vertices are split where the UVs of their corners differ.
typedef struct CagecastSplit {
  const uint32_t* sources;  ///< 1 per new vertex: the vertex that it copies.
  const uint32_t* indices;  ///< The same triangles, as indices of new vertices.
  const float* uvs;         ///< 2 per new vertex.
  uint32_t vertexCount, triangleCount;
  CagecastError error;
  void* memory;  ///< The library's own.
} CagecastSplit;

/// A target, cut along the borders of its cage, with its new vertices last. See `CutTarget`.
typedef struct CagecastCut {
  const uint32_t* sources;  ///< 3 per new vertex: the vertices that it blends.
  const float* weights;     ///< 3 per new vertex: how much of each.
  const uint32_t* indices;  ///< 3 per triangle.
  const uint32_t* origins;  ///< 1 per triangle: the triangle of the target that it is a piece of.
  const float* uvs;         ///< 2 per vertex.
  const float* cornerUvs;   ///< 2 per index with `seams` 1, else NULL.
  const uint8_t* zones;     ///< 1 per vertex.
  const uint8_t* cosmeticTriangles;
  uint32_t vertexCount, newVertexCount, triangleCount;
  CagecastError error;
  void* memory;  ///< The library's own.
} CagecastCut;

/// Fills in the defaults, or, if `paper` is not 0, the preset `paper`.
void cagecastDefaults(CagecastOptions* options, int32_t paper);

/// Carries the cage's UVs to the target, and finds what must not be painted.
/// @param options  NULL for the defaults.
int32_t cagecastTransfer(const CagecastMesh* cage, const CagecastMesh* target, const CagecastOptions* options,
                         CagecastTransfer* out);

/// Decides a transfer anew for another `threshold`, `minCovered`, other parts to keep or exclude, locks or masks: in
/// microseconds.
int32_t cagecastClassify(const CagecastMesh* target, const CagecastOptions* options, CagecastTransfer* transfer);

/// Splits vertices so that UVs per corner become UVs per vertex.
/// @param mesh       The target, or a mesh with the indices and the number of vertices of a cut. Only these are read.
/// @param cornerUvs  2 per index: those of the transfer, or of the cut.
int32_t cagecastSplit(const CagecastMesh* mesh, const float* cornerUvs, CagecastSplit* out);

/// Cuts a target along the borders of its cage and, with `seams` 1, along the seams of the texture.
/// @param transfer  That of the same cage, target and options.
int32_t cagecastCut(const CagecastMesh* cage, const CagecastMesh* target, const CagecastOptions* options,
                    const CagecastTransfer* transfer, CagecastCut* out);

void cagecastFreeTransfer(CagecastTransfer* transfer);
void cagecastFreeSplit(CagecastSplit* split);
void cagecastFreeCut(CagecastCut* cut);

// What follows is in the library of cages. See cages.hpp.

typedef struct CagecastLandmark {
  const char* name;
  float position[3];
  float confidence;  ///< 0..1: 1 if a person gave it.
} CagecastLandmark;

typedef struct CagecastJoint {
  const char* name;
  float position[3];
  int32_t parent;  ///< -1 for a root.
} CagecastJoint;

/// What a part looks like without light.
typedef struct CagecastBaseColor {
  float factor[3];        ///< Red, green, blue in linear light.
  const uint8_t* pixels;  ///< 4 per pixel (sRGB and alpha), upper row first; or NULL.
  uint32_t width, height;
  int32_t isKnown;  ///< Whether this says all.
} CagecastBaseColor;

/// What a cage is for. Zeroed but for `mesh`, nothing more is known of it.
typedef struct CagecastModel {
  CagecastMesh mesh;
  const char* const* parts;  ///< Names by the numbers in `groups`.
  const CagecastJoint* joints;
  const uint16_t* vertexJoints;  ///< 1 per vertex, or NULL: the joint that holds it most; 0xffff for none.
  const uint8_t* marks;          ///< 1 per triangle, or NULL: 1 must not be painted.
  const CagecastLandmark* hints;
  const CagecastBaseColor* baseColors;  ///< By the numbers in `groups`.
  uint32_t partCount, jointCount, hintCount, baseColorCount;
} CagecastModel;

/// Zeros mean: by what the model is, which NULL in place of options means as well.
typedef struct CagecastCageOptions {
  CagecastList keep, exclude;         ///< Parts that are painted, or not, whatever their names.
  int32_t kind;                       ///< To make: 0 automatic, 1 head, 2 body, 3 prop.
  uint32_t triangles, voxels;         ///< To make: of the cage, about; along the model's longest side.
  float closing, offset;              ///< To make: shares of the model's diagonal.
  const CagecastLandmark* landmarks;  ///< To fit: those of the model that are known.
  uint32_t landmarkCount;
  /// Hears how far a call is, 0..1, and what it does, and returns 0 to end it (`aborted`). It must not throw. Or NULL.
  int32_t (*progress)(float share, const char* stage, void* user);
  void* user;  ///< Is given to `progress`.
} CagecastCageOptions;

/// A cage that was made or fitted.
typedef struct CagecastCage {
  CagecastMesh mesh;                  ///< With UVs.
  const CagecastLandmark* landmarks;  ///< Spots of the model.
  const char* const* missing;         ///< Of a fit: landmarks of the template that are not known on the model.
  const char* const* guessed;         ///< Of a fit: landmarks that are used with a guess.
  CagecastList bare, closed;          ///< Of a fit: parts without paint; vertices on borders of holes that were closed.
  uint32_t landmarkCount, missingCount, guessedCount;
  int32_t kind;
  CagecastError error;
  void* memory;  ///< The library's own.
} CagecastCage;

/// Makes a cage for a model.
int32_t cagecastMakeCage(const CagecastModel* model, const CagecastCageOptions* options, CagecastCage* out);

/// Moves a template onto another model.
/// @param from  The template, such as a cage that was made: its mesh, landmarks and kind are read.
int32_t cagecastFitCage(const CagecastCage* from, const CagecastModel* model, const CagecastCageOptions* options,
                        CagecastCage* out);

void cagecastFreeCage(CagecastCage* cage);

#ifdef __cplusplus
}
#endif
#endif
