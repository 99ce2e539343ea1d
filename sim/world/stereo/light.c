#include "sim/world/stereo/light.h"

#include "sim/base/noise3.h"

/* Room light at every point, relative to the projector's light on a frontal surface at 600 mm. */
static const double ambient = 0.03;
/* A point this far behind the surface that the projector sees is in shadow. */
static const double shadow_mm = 4.0;

static double texture(struct iso_vec3 p, double size_mm, uint64_t key)
{
    return sim_noise3(key, iso_scale(1.0 / size_mm, p));
}

/* Albedo of a material that is not painted, 0..1. */
static double base(enum sim_material material)
{
    static const double levels[] = {
        [SIM_SKIN] = 0.55, [SIM_HAIR] = 0.18,   [SIM_CLOTH] = 0.45, [SIM_WALL] = 0.7,
        [SIM_PAPER] = 0.8, [SIM_PLASTIC] = 0.6, [SIM_GLASS] = 0.03, /* reflects light away */
    };
    return (size_t)material < sizeof levels / sizeof *levels ? levels[material] : 0.0;
}

/* Variation from millimetre to millimetre, with values around 1. */
static double grain(enum sim_material material, struct iso_vec3 p, uint64_t key)
{
    switch (material) {
    case SIM_SKIN:
        return 1.0 + 0.05 * texture(p, 6.0, key) + 0.05 * texture(p, 1.2, key + 1);
    case SIM_HAIR:
        return 1.0 + 0.5 * texture(iso_vec3(p.x, p.y / 8.0, p.z), 1.0, key);
    case SIM_CLOTH:
        return 1.0 + 0.25 * texture(p, 2.0, key);
    case SIM_PLASTIC:
        return 1.0 + 0.03 * texture(p, 1.0, key);
    case SIM_PAPER:
    case SIM_WALL:
        return 1.0 + 0.02 * texture(p, 5.0, key);
    default:
        return 1.0;
    }
}

double sim_albedo(const struct sim_facet *facet, struct iso_vec3 point_mm, uint64_t key)
{
    const double painted = (double)facet->albedo;
    return (painted > 0.0 ? painted : base(facet->material)) *
           grain(facet->material, point_mm, key);
}

/* Uniform 0..1 deviates of a cell (splitmix64's finaliser). */
static void draw_cell(uint64_t key, int column, int row, double out[3])
{
    uint64_t h = key ^ ((uint64_t)(uint32_t)column << 32 | (uint32_t)row);
    for (int i = 0; i < 3; i++) {
        h += UINT64_C(0x9e3779b97f4a7c15);
        uint64_t z = (h ^ (h >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
        out[i] = (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
}

double sim_dots(const struct sim_stereo_rig *rig, double x, double y, double radius)
{
    double spacing = rig->dot_spacing, sum = 0.0;
    const int column = (int)floor(x / spacing), row = (int)floor(y / spacing);
    for (int k = 0; k < 9; k++) {
        double cell[3];
        const int c = column + k % 3 - 1, r = row + k / 3 - 1;
        draw_cell(rig->dots_key, c, r, cell);
        const double dx = x - (c + cell[0]) * spacing, dy = y - (r + cell[1]) * spacing;
        const double weight = 0.5 + cell[2];
        sum += weight * exp(-0.5 * (dx * dx + dy * dy) / (radius * radius));
    }
    /* A dot's light is 2 pi radius^2 times its height. */
    return sum * spacing * spacing / (6.283185307179586 * radius * radius);
}

/* Projector light at a point that is not in shadow; mean 1. */
static double pattern(const struct sim_light *light, struct iso_vec3 p, bool skin)
{
    const struct sim_stereo_rig *rig = light->rig;
    if (!rig->dots) {
        return 1.0;
    }
    const double scatter = skin ? rig->scatter_mm / p.z : 0.0;
    const double radius = sqrt(rig->dot_radius * rig->dot_radius + scatter * scatter);
    const double flood = rig->flood_share +
                         (1.0 - rig->flood_share) * (skin ? rig->scatter_share : 0.0);
    return flood + (1.0 - flood) * sim_dots(rig, p.x / p.z, p.y / p.z, radius);
}

double sim_light_at(const struct sim_light *light, struct iso_vec3 point_mm,
                    const struct sim_facet *facet)
{
    const bool skin = facet->material == SIM_SKIN;
    const struct iso_camera *camera = &light->view->camera;
    struct iso_vec3 p = iso_rigid_apply(&light->view_from_scene, point_mm);
    double u, v, shade = 0.0;
    if (iso_camera_project(camera, p, &u, &v) && u > -0.5 && v > -0.5 &&
        u < camera->width_px - 0.5 && v < camera->height_px - 0.5) {
        const size_t i = (size_t)lrint(v) * (size_t)camera->width_px + (size_t)lrint(u);
        const bool lit = p.z < (double)light->view->depth_mm[i] + shadow_mm;
        shade = lit ? (double)light->shade[i] : 0.0;
    }
    const double distance = iso_norm(p) / 600.0;
    double light_in = ambient;
    if (shade > 0.0) {
        light_in += shade * pattern(light, p, skin) / (distance * distance);
    }
    return light_in * sim_albedo(facet, point_mm, light->key);
}

void sim_light_shade(const struct sim_view *view, float *shade)
{
    const int width = view->camera.width_px, height = view->camera.height_px;
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            const size_t i = (size_t)row * (size_t)width + (size_t)column;
            float sum = 0.0f, n = 0.0f;
            if (view->material[i] == SIM_NOTHING) {
                shade[i] = 0.0f;
                continue;
            }
            for (int k = 0; k < 49; k++) {
                const int x = column + k % 7 - 3, y = row + k / 7 - 3;
                const size_t at = (size_t)y * (size_t)width + (size_t)x;
                if (x >= 0 && y >= 0 && x < width && y < height &&
                    view->material[at] == view->material[i]) {
                    sum += view->cosine[at];
                    n += 1.0f;
                }
            }
            shade[i] = sum / n;
        }
    }
}
