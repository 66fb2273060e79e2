/* The C interface as C99 calls it: a cage for a cube is made, carries its UVs over, is cut, split, fitted, and freed.
 */
#include "cagecast/cagecast_c.h"

#include <stdio.h>
#include <string.h>

static int failures = 0;
#define CHECK(condition) \
  ((condition) ? (void)0 : (void)(++failures, fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition)))

static const float kPositions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
static const uint32_t kIndices[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
static const CagecastMesh kCube = {kPositions, kIndices, 0, 0, 0, 8, 12, 0};

static void testTransfer(const CagecastMesh* cage) {
  CagecastOptions options;
  cagecastDefaults(&options, 0);
  CHECK(options.threshold == 0.5f && options.seams == 1 && options.motion == 1);

  CagecastTransfer transfer;
  memset(&transfer, 0, sizeof transfer);
  CHECK(cagecastTransfer(cage, &kCube, NULL, &transfer) == 0);
  CHECK(transfer.vertexCount == 8 && transfer.triangleCount == 12 && transfer.segmentCount == 1);
  for (uint32_t v = 0; v < transfer.vertexCount; ++v) CHECK(transfer.zones[v] == 0);

  CagecastSplit split;
  memset(&split, 0, sizeof split);
  CHECK(cagecastSplit(&kCube, transfer.cornerUvs, &split) == 0);
  CHECK(split.vertexCount >= 8 && split.triangleCount == 12);
  CHECK(memcmp(split.uvs, transfer.cornerUvs, 2 * sizeof(float)) == 0);

  CagecastCut cut;
  memset(&cut, 0, sizeof cut);
  CHECK(cagecastCut(cage, &kCube, NULL, &transfer, &cut) == 0);
  CHECK(cut.vertexCount == 8 + cut.newVertexCount && cut.triangleCount >= 12);

  CagecastLock lock = {0, 2};
  options.locks = &lock;
  options.lockCount = 1;
  CHECK(cagecastClassify(&kCube, &options, &transfer) == 0);
  CHECK(transfer.segmentStats[0].culledBy == 3 && transfer.zones[0] == 3);

  options.threshold = 2;
  CHECK(cagecastTransfer(cage, &kCube, &options, &transfer) == 1 && transfer.zones == NULL);
  CHECK(strcmp(transfer.error.code, "badOption") == 0 && strcmp(transfer.error.option, "threshold") == 0);
  CHECK(strstr(transfer.error.message, "threshold = 2") != NULL);
  /* What follows an error finds nothing. */
  CHECK(cagecastClassify(&kCube, NULL, &transfer) == 1);
  CHECK(strcmp(transfer.error.code, "resultMismatch") == 0);
  CHECK(cagecastCut(cage, &kCube, NULL, &transfer, &cut) == 1 && cut.indices == NULL);

  cagecastFreeTransfer(&transfer);
  cagecastFreeTransfer(&transfer);
  cagecastFreeSplit(&split);
  cagecastFreeCut(&cut);
}

#ifdef CAGECAST_CAGES
static int32_t count(float share, const char* stage, void* user) {
  CHECK(share >= 0 && share <= 1 && stage != NULL);
  return ++*(int*)user < 3;
}

int main(void) {
  CagecastModel model;
  memset(&model, 0, sizeof model);
  model.mesh = kCube;
  CagecastCage cage;
  memset(&cage, 0, sizeof cage);
  CHECK(cagecastMakeCage(&model, NULL, &cage) == 0);
  CHECK(cage.mesh.triangleCount == 600 && cage.mesh.uvs != NULL && cage.kind == 3);
  testTransfer(&cage.mesh);

  /* A made cage is a template, here for a cube of twice the size. */
  const CagecastLandmark corners[] = {
      {"a", {0, 0, 0}, 1}, {"b", {1, 0, 0}, 1}, {"c", {0, 1, 0}, 1}, {"d", {0, 0, 1}, 1}, {"e", {1, 1, 1}, 1}};
  float positions[24];
  CagecastLandmark twice[5];
  CagecastCageOptions options;
  memset(&options, 0, sizeof options);
  for (int i = 0; i < 24; ++i) positions[i] = 2 * kPositions[i];
  memcpy(twice, corners, sizeof twice);
  for (int i = 0; i < 15; ++i) twice[i / 3].position[i % 3] *= 2;
  cage.landmarks = corners;
  cage.landmarkCount = 5;
  model.mesh.positions = positions;
  options.landmarks = twice;
  options.landmarkCount = 5;
  CagecastCage fitted;
  memset(&fitted, 0, sizeof fitted);
  CHECK(cagecastFitCage(&cage, &model, &options, &fitted) == 0);
  CHECK(fitted.mesh.vertexCount == cage.mesh.vertexCount && fitted.missingCount == 0);
  CHECK(fitted.landmarkCount == 5 && strcmp(fitted.landmarks[4].name, "e") == 0);

  /* Which may take the place of its template. */
  CHECK(cagecastFitCage(&cage, &model, &options, &cage) == 0 && cage.mesh.vertexCount == fitted.mesh.vertexCount);

  int calls = 0;
  options.progress = count;
  options.user = &calls;
  CHECK(cagecastMakeCage(&model, &options, &fitted) == 1 && calls == 3);
  CHECK(strcmp(fitted.error.code, "aborted") == 0 && fitted.mesh.positions == NULL);
  options.progress = NULL;
  options.landmarks = NULL;
  model.mesh.triangleCount = 0;
  CHECK(cagecastMakeCage(&model, &options, &fitted) == 1 && strcmp(fitted.error.argument, "model") == 0);
  CHECK(cagecastMakeCage(NULL, NULL, &fitted) == 1 && strcmp(fitted.error.argument, "model") == 0);
  CHECK(cagecastFitCage(NULL, &model, NULL, &fitted) == 1 && fitted.error.message[0] != 0);
  CHECK(cagecastFitCage(&cage, NULL, NULL, &fitted) == 1 && strcmp(fitted.error.argument, "model") == 0);
  cagecastFreeCage(&fitted);
  cagecastFreeCage(&cage);
  return failures != 0;
}
#else
int main(void) {
  const float positions[] = {-9, -9, -1, 9, -9, -1, 0, 9, -1, 0, 0, 9}, uvs[] = {0, 0, 1, 0, 0, 1, 1, 1};
  const uint32_t indices[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const CagecastMesh cage = {positions, indices, uvs, 0, 0, 4, 4, 0};
  testTransfer(&cage);
  return failures != 0;
}
#endif
