#include "sim/base/noise3.h"

/* A hash of a lattice point, mapped to -1..1 (splitmix64's finaliser). */
static double lattice(uint64_t key, int64_t x, int64_t y, int64_t z)
{
    uint64_t h = key ^ (uint64_t)x * UINT64_C(0x9e3779b97f4a7c15);
    h ^= (uint64_t)y * UINT64_C(0xc2b2ae3d27d4eb4f);
    h ^= (uint64_t)z * UINT64_C(0x165667b19e3779f9);
    h = (h ^ (h >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ (h >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((h ^ (h >> 31)) >> 11) * 0x1p-52 - 1.0;
}

static double smooth(double f)
{
    return f * f * (3.0 - 2.0 * f);
}

double sim_noise3(uint64_t key, struct iso_vec3 p)
{
    double corner[3] = {floor(p.x), floor(p.y), floor(p.z)};
    double w[3] = {smooth(p.x - corner[0]), smooth(p.y - corner[1]), smooth(p.z - corner[2])};
    int64_t at[3] = {(int64_t)corner[0], (int64_t)corner[1], (int64_t)corner[2]};
    double sum = 0.0;
    for (int i = 0; i < 8; i++) {
        const int dx = i & 1, dy = (i >> 1) & 1, dz = i >> 2;
        const double weight = (dx ? w[0] : 1.0 - w[0]) * (dy ? w[1] : 1.0 - w[1]) *
                              (dz ? w[2] : 1.0 - w[2]);
        sum += weight * lattice(key, at[0] + dx, at[1] + dy, at[2] + dz);
    }
    return sum;
}
