#include "sim/world/prop/furniture.h"

#include "sim/base/noise3.h"
#include "sim/world/prop/sheet.h"
#include "sim/world/prop/torso.h"

static void add_bar(struct sim_group *group, struct iso_vec3 from, struct iso_vec3 to,
                    double radius_mm, enum sim_material material)
{
    const struct sim_joint joints[2] = {{from, radius_mm}, {to, radius_mm}};
    sim_group_add_tube(group, joints, 2, material);
}

/* ---- chairs ----------------------------------------------------------------- */

struct chair {
    double half_width_mm, half_height_mm, bar_mm;
    int n; /* bars or boards */
};

static void add_post(struct sim_group *group, const struct chair *chair, double side,
                     struct sim_random *random)
{
    const double x = side * chair->half_width_mm, top = -chair->half_height_mm - 10.0;
    add_bar(group, iso_vec3(x, top, 0.0), iso_vec3(0.97 * x, 900.0, 30.0), chair->bar_mm + 3.0,
            SIM_PLASTIC);
    const double knob = sim_random_between(random, 16.0, 30.0);
    struct iso_vec3 half = {knob, 1.15 * knob, knob};
    sim_group_add_ellipsoid(group, half, 1.0, iso_vec3(x, top - knob, 0.0), SIM_PLASTIC);
}

static void add_slats(struct sim_group *group, const struct chair *chair)
{
    const double w = chair->half_width_mm, h = chair->half_height_mm;
    add_bar(group, iso_vec3(-w, -h, 0.0), iso_vec3(w, -h, 0.0), chair->bar_mm + 4.0, SIM_PLASTIC);
    add_bar(group, iso_vec3(-w, h, 0.0), iso_vec3(w, h, 0.0), chair->bar_mm, SIM_PLASTIC);
    for (int i = 1; i <= chair->n; i++) {
        const double x = w * (2.0 * i / (chair->n + 1) - 1.0);
        add_bar(group, iso_vec3(x, -h, 0.0), iso_vec3(x, h, 0.0), 0.8 * chair->bar_mm, SIM_PLASTIC);
    }
}

/* Adds boards that are slightly bent to fit a person's back. */
static void add_boards(struct sim_group *group, const struct chair *chair)
{
    struct iso_rigid before = group->placed;
    for (int i = 0; i < chair->n; i++) {
        struct sim_solid *board = NULL;
        const double y = chair->half_height_mm * (2.0 * (i + 0.5) / chair->n - 1.0);
        struct iso_rigid at = {iso_mat3_identity(), {0.0, y, 12.0}};
        const int made = sim_solid_rectangle(2.0 * chair->half_width_mm,
                                             1.1 * chair->half_height_mm / chair->n, 700.0,
                                             SIM_PLASTIC, &board);
        group->placed = iso_rigid_mul(&before, &at);
        sim_group_add(group, made, board);
    }
    group->placed = before;
}

static void add_shell(struct sim_group *group, const struct chair *chair, struct sim_random *random)
{
    struct sim_solid *shell = NULL;
    const int made = sim_solid_rectangle(2.0 * chair->half_width_mm, 2.0 * chair->half_height_mm,
                                         sim_random_between(random, 250.0, 600.0), SIM_PLASTIC,
                                         &shell);
    sim_group_add(group, made, shell);
    add_bar(group, iso_vec3(0.0, chair->half_height_mm, 12.0), iso_vec3(0.0, 900.0, 60.0), 20.0,
            SIM_PLASTIC);
}

void sim_furniture_add_chair(struct sim_group *group, enum sim_chair_back back,
                             struct sim_random *random)
{
    struct chair chair = {.half_width_mm = sim_random_between(random, 160.0, 230.0)};
    chair.half_height_mm = sim_random_between(random, 130.0, 240.0);
    chair.bar_mm = sim_random_between(random, 9.0, 16.0);
    chair.n = 3 + (int)sim_random_below(random, 4);
    const double w = chair.half_width_mm, h = chair.half_height_mm;
    if (back == SIM_CHAIR_SHELL) {
        add_shell(group, &chair, random);
    } else if (back == SIM_CHAIR_PADDED) {
        struct iso_vec3 half = {w, h, sim_random_between(random, 30.0, 55.0)};
        sim_group_add_ellipsoid(group, half, 0.35, iso_vec3(0.0, 0.0, half.z), SIM_CLOTH);
        add_bar(group, iso_vec3(0.0, h, 60.0), iso_vec3(0.0, 900.0, 90.0), 25.0, SIM_PLASTIC);
    } else {
        add_post(group, &chair, -1.0, random);
        add_post(group, &chair, 1.0, random);
        if (back == SIM_CHAIR_SLATS) {
            add_slats(group, &chair);
        } else {
            add_boards(group, &chair);
        }
    }
    struct iso_vec3 seat = {2.1 * w, 45.0, 420.0};
    sim_group_add_box(group, seat, iso_vec3(0.0, h + 190.0, -200.0), SIM_CLOTH);
}

/* ---- plants, cushions, balls ------------------------------------------------ */

/* Adds an arched leaf that begins at `root` and grows in a random direction. */
static void add_leaf(struct sim_group *group, struct iso_vec3 root, struct sim_random *random)
{
    struct sim_sheet leaf = {.shape = SIM_SHEET_ROLLED, .outline = true, .axis_rad = 1.5707963};
    leaf.width_mm = sim_random_between(random, 30.0, 75.0);
    leaf.height_mm = leaf.width_mm * sim_random_between(random, 1.8, 3.4);
    leaf.radius_mm = sim_random_between(random, 0.7, 2.5) * leaf.height_mm;
    const double around = sim_random_between(random, -3.14, 3.14);
    const double tilt = sim_random_between(random, 0.1, 1.3);
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(0.0, around, 0.0));
    struct iso_mat3 lean = iso_mat3_rotation(iso_vec3(tilt, 0.0, 0.0));
    struct iso_rigid grown = {iso_mat3_mul(&turn, &lean), root};
    struct iso_rigid half_up = {iso_mat3_identity(), {0.0, -0.5 * leaf.height_mm, 0.0}};
    struct iso_rigid before = group->placed, here = iso_rigid_mul(&grown, &half_up);
    struct sim_solid *solid = NULL;
    const int made = sim_sheet_new(&leaf, SIM_CLOTH, &solid);
    group->placed = iso_rigid_mul(&before, &here);
    sim_group_add(group, made, solid);
    group->placed = before;
}

void sim_furniture_add_plant(struct sim_group *group, struct sim_random *random)
{
    const double pot_mm = sim_random_between(random, 60.0, 100.0), spread = 0.9 * pot_mm;
    struct iso_vec3 base = {0.0, 150.0, 0.0}, pot = {pot_mm, 0.9 * pot_mm, pot_mm};
    sim_group_add_ellipsoid(group, pot, 0.25, iso_vec3(0.0, 140.0 + pot.y, 0.0), SIM_PLASTIC);
    const int stems = 7 + (int)sim_random_below(random, 8);
    for (int s = 0; s < stems; s++) {
        const double x = spread * sim_random_normal(random), z = spread * sim_random_normal(random);
        struct iso_vec3 tip = {x, sim_random_between(random, -110.0, 60.0), z};
        add_bar(group, base, tip, 3.0, SIM_CLOTH);
        const int leaves = 2 + (int)sim_random_below(random, 4);
        for (int l = 0; l < leaves; l++) {
            const double along = 0.5 + 0.5 * (l + 1) / leaves;
            add_leaf(group, iso_madd(base, along, iso_sub(tip, base)), random);
        }
    }
}

void sim_furniture_add_cushion(struct sim_group *group, struct sim_random *random)
{
    const double width = sim_random_between(random, 120.0, 230.0);
    const double height = width * sim_random_between(random, 0.6, 1.0);
    struct iso_vec3 half = {width, height, sim_random_between(random, 45.0, 90.0)};
    const double roundness = sim_random_between(random, 0.5, 0.8);
    struct sim_solid *cushion = NULL;
    const uint64_t key = sim_random_u64(random);
    const int made = sim_solid_superellipsoid(half, roundness, SIM_CLOTH, &cushion);
    for (uint32_t i = 0; made == 0 && i < cushion->n_vertices; i++) {
        struct iso_vec3 *p = &cushion->vertices_mm[i];
        const double dent = 14.0 * sim_noise3(key, iso_scale(1.0 / 90.0, *p)) +
                            4.0 * sim_noise3(key + 1, iso_scale(1.0 / 30.0, *p));
        p->z += dent;
    }
    sim_group_add(group, made, cushion);
}

void sim_furniture_add_ball(struct sim_group *group, double radius_mm, bool balloon,
                            struct sim_random *random)
{
    const double length = balloon ? sim_random_between(random, 1.08, 1.35) : 1.0;
    struct iso_vec3 half = {radius_mm, length * radius_mm, radius_mm};
    struct iso_vec3 none = {0.0, 0.0, 0.0};
    sim_group_add_ellipsoid(group, half, 1.0, none, SIM_PLASTIC);
    if (balloon) {
        const struct sim_joint neck[] = {{{0.0, 0.9 * half.y, 0.0}, 0.3 * radius_mm},
                                         {{0.0, 1.12 * half.y, 0.0}, 6.0}};
        sim_group_add_tube(group, neck, 2, SIM_PLASTIC);
        add_bar(group, iso_vec3(0.0, 1.1 * half.y, 0.0), iso_vec3(15.0, half.y + 600.0, 10.0), 3.0,
                SIM_PLASTIC);
    }
}

/* ---- coats ------------------------------------------------------------------ */

void sim_furniture_add_coat(struct sim_group *group, bool hanger, struct sim_random *random)
{
    /* The collar in the face frame of sim/world/prop/torso.h. The trunk is moved so that the collar
     * is at the origin, and faces the viewer. */
    static const struct iso_vec3 collar_mm = {0.0, -128.0, -128.0};
    struct sim_solid *trunk = NULL;
    const double flat = hanger ? sim_random_between(random, 0.3, 0.6) : 1.0;
    const int made = sim_torso_new(sim_random_u64(random), &trunk);
    for (uint32_t i = 0; made == 0 && i < trunk->n_vertices; i++) {
        struct iso_vec3 p = iso_sub(trunk->vertices_mm[i], collar_mm);
        trunk->vertices_mm[i] = iso_vec3(p.x, -p.y, -flat * p.z);
    }
    sim_group_add(group, made, trunk);
    if (hanger) {
        const struct sim_joint hook[] = {{{0.0, 20.0, 0.0}, 4.0},
                                         {{0.0, -35.0, 0.0}, 4.0},
                                         {{18.0, -60.0, 0.0}, 4.0},
                                         {{8.0, -85.0, 0.0}, 4.0},
                                         {{-16.0, -78.0, 0.0}, 4.0}};
        sim_group_add_tube(group, hook, 5, SIM_PLASTIC);
        add_bar(group, iso_vec3(-45.0, 22.0, 0.0), iso_vec3(45.0, 22.0, 0.0), 9.0, SIM_PLASTIC);
        add_bar(group, iso_vec3(-500.0, -95.0, 0.0), iso_vec3(500.0, -95.0, 0.0), 12.0,
                SIM_PLASTIC);
    } else {
        struct iso_vec3 stump = {sim_random_between(random, 50.0, 62.0), 45.0, 58.0};
        sim_group_add_ellipsoid(group, stump, 0.6, iso_vec3(0.0, -18.0, 0.0), SIM_CLOTH);
    }
}
