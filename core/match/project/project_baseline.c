/* For every processor of the architecture: SSE2 on x86-64, NEON on aarch64. */
enum { WIDE = 4 };
#define PROJECT iso__project_baseline
#include "core/match/project/project.inc"
