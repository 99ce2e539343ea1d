#include "sim/base/random.h"

#include <math.h>

static uint64_t splitmix64(uint64_t *x)
{
    uint64_t z = (*x += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

struct sim_random sim_random_seeded(uint64_t seed, uint64_t stream, uint64_t index)
{
    struct sim_random random = {{0}, 0.0, false};
    uint64_t x = seed;
    x = splitmix64(&x) ^ stream;
    x = splitmix64(&x) ^ index;
    for (int i = 0; i < 4; i++) {
        random.state[i] = splitmix64(&x);
    }
    return random;
}

uint64_t sim_random_hash(const char *text)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (; *text; text++) {
        hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static uint64_t rotated(uint64_t x, int k)
{
    return (x << k) | (x >> (64 - k));
}

uint64_t sim_random_u64(struct sim_random *random)
{
    uint64_t *s = random->state;
    const uint64_t result = rotated(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotated(s[3], 45);
    return result;
}

double sim_random_unit(struct sim_random *random)
{
    return (double)(sim_random_u64(random) >> 11) * 0x1p-53;
}

double sim_random_between(struct sim_random *random, double from, double to)
{
    return from + (to - from) * sim_random_unit(random);
}

double sim_random_normal(struct sim_random *random)
{
    if (random->has_spare) {
        random->has_spare = false;
        return random->spare;
    }
    double x, y, r2;
    do {
        x = sim_random_between(random, -1.0, 1.0);
        y = sim_random_between(random, -1.0, 1.0);
        r2 = x * x + y * y;
    } while (r2 >= 1.0 || r2 <= 0.0);
    const double scale = sqrt(-2.0 * log(r2) / r2);
    random->spare = y * scale;
    random->has_spare = true;
    return x * scale;
}

uint32_t sim_random_below(struct sim_random *random, uint32_t n)
{
    /* The bias is below n / 2^32, far below the resolution of any simulation here. */
    return (uint32_t)(((sim_random_u64(random) >> 32) * n) >> 32);
}
