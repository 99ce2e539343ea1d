#include "core/presentation/frame_memory.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    REACH_TILES = 10, /* tiles to each side of the nose */
    SIDE = 4,         /* pixels of a tile that are read, in each direction */
    SAMPLES = SIDE * SIDE,
    SAMPLES_MIN = 12, /* the least of these pixels that must be as far away as the face */
    SLOPES_MIN = 4,   /* the least differences that must not be 0: a flat tile has no content */
};

/* A tile has the same number of pixels at every distance, namely what 12 mm cover at 700 mm. A
 * constant that is added to all depths therefore does not change the tiles. */
static const double tile_mm = 12.0, tile_distance_mm = 700.0;

/* The range of depths, counted from the nose tip, that counts as being as far away as the face. */
static const float nearer_mm = 60.0F, farther_mm = 120.0F;

/* The resolution of differences: finer than any sensor's, coarser than the rounding of a float. */
static const float steps_per_mm = 8.0F;

static const int32_t not_measured = INT32_MIN;

struct tile {
    int32_t x, y; /* counted in the camera's image */
    int valid, slopes;
    uint32_t hash;
};

static uint32_t mix_hash(uint32_t hash, uint32_t value)
{
    return (hash ^ value) * UINT32_C(0x9e3779b1) ^ (hash >> 15);
}

/* The last steps of MurmurHash3 (Appleby): every bit depends on every other. */
static uint32_t finish_hash(uint32_t hash)
{
    hash = (hash ^ (hash >> 16)) * UINT32_C(0x85ebca6b);
    hash = (hash ^ (hash >> 13)) * UINT32_C(0xc2b2ae35);
    return hash ^ (hash >> 16);
}

struct view {
    const struct iso_frame *frame;
    int pitch_px;
    float from_mm, to_mm;
};

/* The depth at a pixel of the camera's image; 0 if nothing as far away as the face is measured
 * there. */
static float depth_at(const struct view *view, int u, int v)
{
    const struct iso_frame *frame = view->frame;
    const int column = u - frame->crop_x_px, row = v - frame->crop_y_px;
    if (column < 0 || row < 0 || column >= frame->width_px || row >= frame->height_px) {
        return 0.0F;
    }
    const float z_mm = iso_frame_depth_at(frame, column, row);
    return z_mm > view->from_mm && z_mm < view->to_mm ? z_mm : 0.0F;
}

static void read_tile(const struct view *view, struct tile *tile)
{
    float before_mm = 0.0F;
    tile->hash = mix_hash(mix_hash(UINT32_C(0x6a09e667), (uint32_t)tile->x), (uint32_t)tile->y);
    for (int i = 0; i < SAMPLES; i++) {
        const int u = tile->x * view->pitch_px + i % SIDE * view->pitch_px / SIDE;
        const int v = tile->y * view->pitch_px + i / SIDE * view->pitch_px / SIDE;
        const float z_mm = depth_at(view, u, v);
        int32_t step = not_measured;
        if (z_mm > 0.0F) {
            tile->valid++;
            step = before_mm > 0.0F ? (int32_t)lrintf((z_mm - before_mm) * steps_per_mm) : 0;
            tile->slopes += step != 0;
            before_mm = z_mm;
        }
        tile->hash = mix_hash(tile->hash, (uint32_t)step);
    }
    tile->hash = finish_hash(tile->hash);
}

static int pitch_of(const struct iso_camera *camera)
{
    const double pitch_px = tile_mm / iso_camera_pixel_mm(camera, tile_distance_mm);
    return pitch_px > SIDE ? (int)pitch_px : SIDE;
}

struct iso_fingerprint iso_fingerprint_of(const struct iso_frame *frame, struct iso_vec3 nose_mm)
{
    struct iso_fingerprint print = {{0}, 0};
    uint32_t least[ISO_FINGERPRINT_CLASSES];
    double u = 0.0, v = 0.0;
    const struct view view = {
        .frame = frame,
        .pitch_px = pitch_of(&frame->camera),
        .from_mm = fmaxf((float)nose_mm.z - nearer_mm, 0.0F),
        .to_mm = (float)nose_mm.z + farther_mm,
    };
    if (!iso_camera_project(&frame->camera, nose_mm, &u, &v)) {
        return print;
    }
    memset(least, 0xff, sizeof least);
    const int x = (int)floor(u / view.pitch_px), y = (int)floor(v / view.pitch_px);
    for (int ty = y - REACH_TILES; ty <= y + REACH_TILES; ty++) {
        for (int tx = x - REACH_TILES; tx <= x + REACH_TILES; tx++) {
            struct tile tile = {.x = tx, .y = ty};
            read_tile(&view, &tile);
            const uint32_t class = tile.hash % ISO_FINGERPRINT_CLASSES;
            const uint32_t rank = tile.hash / ISO_FINGERPRINT_CLASSES;
            if (tile.valid >= SAMPLES_MIN && tile.slopes >= SLOPES_MIN && rank < least[class]) {
                least[class] = rank;
                print.filled += print.of[class] == 0;
                print.of[class] = (uint8_t)(1 + rank % UINT8_MAX);
            }
        }
    }
    return print;
}

/* How many bytes are equal. The compiler uses vector instructions for this loop. */
static int count_equal(const uint8_t *a, const uint8_t *b)
{
    uint8_t n = 0;
    for (int i = 0; i < ISO_FINGERPRINT_CLASSES; i++) {
        n = (uint8_t)(n + (a[i] == b[i]));
    }
    return n;
}

/* Classes that are empty in both fingerprints do not count. */
double iso_fingerprint_likeness(const struct iso_fingerprint *a, const struct iso_fingerprint *b)
{
    int same = 0, filled = 0;
    for (int i = 0; i < ISO_FINGERPRINT_CLASSES; i++) {
        filled += a->of[i] != 0 || b->of[i] != 0;
        same += a->of[i] != 0 && a->of[i] == b->of[i];
    }
    return filled > 0 ? (double)same / filled : 0.0;
}

/* ---- the memory ---- */

struct entry {
    int64_t t_ns;
    uint8_t of[ISO_FINGERPRINT_CLASSES];
};

struct iso_frame_memory {
    struct iso_frame_memory_options options;
    int n, next; /* entries held, and where the next one goes */
    struct entry *entries;
};

struct iso_frame_memory_options iso_frame_memory_options_default(void)
{
    return (struct iso_frame_memory_options){.span_ns = INT64_C(600000000000), .capacity = 18000};
}

int iso_frame_memory_new(const struct iso_frame_memory_options *options,
                         struct iso_frame_memory **out)
{
    if (options->span_ns <= 0 || options->capacity < 1) {
        return -EINVAL;
    }
    struct iso_frame_memory *memory = calloc(1, sizeof *memory);
    if (!memory) {
        return -ENOMEM;
    }
    memory->options = *options;
    memory->entries = calloc((size_t)options->capacity, sizeof *memory->entries);
    if (!memory->entries) {
        free(memory);
        return -ENOMEM;
    }
    *out = memory;
    return 0;
}

void iso_frame_memory_free(struct iso_frame_memory *memory)
{
    if (memory) {
        explicit_bzero(memory->entries, (size_t)memory->options.capacity * sizeof *memory->entries);
        free(memory->entries);
        free(memory);
    }
}

static bool is_known(const struct iso_frame_memory *memory, const uint8_t *of, int filled,
                     int64_t t_ns)
{
    const int empty = ISO_FINGERPRINT_CLASSES - filled;
    for (int i = 0; i < memory->n; i++) {
        const struct entry *entry = &memory->entries[i];
        if (t_ns - entry->t_ns < memory->options.span_ns &&
            count_equal(entry->of, of) - empty >= ISO_FINGERPRINT_SAME * filled) {
            return true;
        }
    }
    return false;
}

bool iso_frame_memory_repeats(struct iso_frame_memory *memory,
                              const struct iso_fingerprint *fingerprint, int64_t t_ns)
{
    if (fingerprint->filled < ISO_FINGERPRINT_MIN) {
        return false;
    }
    const bool known = is_known(memory, fingerprint->of, fingerprint->filled, t_ns);
    struct entry *entry = &memory->entries[memory->next];
    entry->t_ns = t_ns;
    memcpy(entry->of, fingerprint->of, sizeof entry->of);
    memory->next = (memory->next + 1) % memory->options.capacity;
    memory->n = memory->n < memory->options.capacity ? memory->n + 1 : memory->n;
    return known;
}
