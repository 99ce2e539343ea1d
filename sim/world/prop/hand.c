#include "sim/world/prop/hand.h"

enum { FINGERS = 4, JOINTS = 4 };

/* The fingers from the little finger to the index finger: place on the palm, total length of the
 * three phalanges, and angle when the hand is spread. The palm faces the viewer, with the thumb on
 * the viewer's right. The other hand is the mirror image. */
static const struct finger {
    double x_mm, y_mm, length_mm, radius_mm, lean_rad;
} fingers[FINGERS] = {
    {-33.0, -82.0, 62.0, 7.5, -0.30},
    {-12.0, -91.0, 77.0, 8.5, -0.10},
    {10.0, -93.0, 84.0, 9.0, 0.04},
    {31.0, -89.0, 76.0, 8.7, 0.18},
};

/* Length of each phalanx as a share of the finger's length. */
static const double phalanges[JOINTS - 1] = {0.46, 0.30, 0.24};

struct hand {
    struct sim_group *group;
    double size, side; /* scale; side -1 mirrors the hand */
    double spread, curl_rad, held_mm;
};

static struct iso_vec3 placed(const struct hand *hand, struct iso_vec3 p)
{
    return iso_vec3(hand->size * hand->side * p.x, hand->size * p.y, hand->size * p.z);
}

static void add_tube(const struct hand *hand, const struct iso_vec3 *points, const double *radii_mm,
                     size_t n, enum sim_material material)
{
    struct sim_joint joints[8];
    for (size_t i = 0; i < n; i++) {
        joints[i] = (struct sim_joint){placed(hand, points[i]), hand->size * radii_mm[i]};
    }
    sim_group_add_tube(hand->group, joints, n, material);
}

/* A finger whose phalanges bend towards the viewer by `bends_rad`, each relative to the previous
 * one. */
static void add_finger(const struct hand *hand, const struct finger *finger, struct iso_vec3 root,
                       double lean_rad, const double bends_rad[JOINTS - 1])
{
    struct iso_vec3 points[JOINTS] = {root};
    double radii[JOINTS] = {1.08 * finger->radius_mm, finger->radius_mm, 0.95 * finger->radius_mm,
                            0.78 * finger->radius_mm};
    double bent = 0.0;
    for (int k = 0; k + 1 < JOINTS; k++) {
        bent += bends_rad[k];
        struct iso_vec3 direction = {sin(lean_rad) * cos(bent), -cos(lean_rad) * cos(bent),
                                     -sin(bent)};
        points[k + 1] = iso_madd(points[k], finger->length_mm * phalanges[k], direction);
    }
    add_tube(hand, points, radii, JOINTS, SIM_SKIN);
}

static void add_palm(const struct hand *hand, struct iso_vec3 at_mm)
{
    struct iso_vec3 half = iso_scale(hand->size, iso_vec3(43.0, 52.0, 14.0));
    sim_group_add_ellipsoid(hand->group, half, 0.55, placed(hand, at_mm), SIM_SKIN);
    /* The balls of the thumb and of the little finger. */
    const struct iso_vec3 thumb[] = {{14, -22, -7}, {30, -50, -10}};
    const struct iso_vec3 little[] = {{-18, -18, -6}, {-29, -58, -7}};
    static const double thick[] = {17.0, 15.0}, thin[] = {14.0, 13.0};
    struct iso_vec3 offset = {at_mm.x, at_mm.y + 46.0, at_mm.z};
    for (int ball = 0; ball < 2; ball++) {
        struct iso_vec3 points[2];
        for (int k = 0; k < 2; k++) {
            points[k] = iso_add(ball == 0 ? thumb[k] : little[k], offset);
        }
        add_tube(hand, points, ball == 0 ? thick : thin, 2, SIM_SKIN);
    }
}

static void add_open(const struct hand *hand)
{
    static const double thumb_radii[] = {14.0, 11.0, 9.5, 8.0};
    const struct iso_vec3 thumb[] = {
        {22, -34, -8}, {48, -58, -12}, {66, -84, -14}, {74, -110, -12}};
    double bends[] = {0.4 * hand->curl_rad, hand->curl_rad, 0.7 * hand->curl_rad};
    add_palm(hand, iso_vec3(0.0, -46.0, 0.0));
    for (int i = 0; i < FINGERS; i++) {
        struct iso_vec3 root = {fingers[i].x_mm, fingers[i].y_mm, 0.0};
        add_finger(hand, &fingers[i], root, hand->spread * fingers[i].lean_rad, bends);
    }
    add_tube(hand, thumb, thumb_radii, 4, SIM_SKIN);
}

/* Fingers folded over the palm, the thumb across them. */
static void add_fist(const struct hand *hand)
{
    static const double thumb_radii[] = {14.0, 11.5, 10.5, 9.0}, bends[] = {1.3, 1.75, 0.9};
    const struct iso_vec3 thumb[] = {{28, -34, -6}, {42, -54, -30}, {24, -66, -48}, {2, -70, -50}};
    add_palm(hand, iso_vec3(0.0, -46.0, 0.0));
    for (int i = 0; i < FINGERS; i++) {
        struct iso_vec3 root = {0.95 * fingers[i].x_mm, fingers[i].y_mm, 0.0};
        struct finger thicker = fingers[i];
        thicker.radius_mm *= 1.12;
        add_finger(hand, &thicker, root, 0.0, bends);
    }
    add_tube(hand, thumb, thumb_radii, 4, SIM_SKIN);
}

/* Palm and fingers are behind the plane z = 0 and the held object, the thumb is in front of it. */
static void add_grip(const struct hand *hand)
{
    static const double thumb_radii[] = {14.0, 12.0, 10.0, 8.5}, bends[] = {0.0, 0.0, 0.0};
    const struct iso_vec3 thumb[] = {{18, -30, 4}, {22, -54, -11}, {14, -78, -12}, {8, -102, -10}};
    const double behind = 20.0 + hand->held_mm / hand->size;
    add_palm(hand, iso_vec3(0.0, -40.0, behind + 2.0));
    for (int i = 0; i < FINGERS; i++) {
        struct iso_vec3 root = {fingers[i].x_mm, fingers[i].y_mm + 8.0, behind};
        add_finger(hand, &fingers[i], root, 0.8 * fingers[i].lean_rad, bends);
    }
    add_tube(hand, thumb, thumb_radii, 4, SIM_SKIN);
}

/* The forearm, from the sleeve to the wrist. */
static void add_forearm(const struct hand *hand, struct sim_random *random)
{
    const double x = sim_random_between(random, -40.0, 110.0);
    const double z = sim_random_between(random, 20.0, 120.0);
    const double cuff = sim_random_between(random, 0.15, 0.6);
    struct iso_vec3 wrist = {0.0, -8.0, 0.0}, elbow = {x, 250.0, z};
    struct iso_vec3 along = iso_sub(elbow, wrist);
    const struct iso_vec3 bare[] = {wrist, iso_madd(wrist, 0.3, along), elbow};
    const struct iso_vec3 sleeve[] = {iso_madd(wrist, cuff, along), elbow,
                                      iso_madd(wrist, 1.6, along)};
    static const double bare_mm[] = {24.0, 29.0, 40.0}, sleeve_mm[] = {43.0, 54.0, 58.0};
    add_tube(hand, bare, bare_mm, 3, SIM_SKIN);
    add_tube(hand, sleeve, sleeve_mm, 3, SIM_CLOTH);
}

void sim_hand_add(struct sim_group *group, enum sim_hand_pose pose, bool left, double held_mm,
                  struct sim_random *random)
{
    struct hand hand = {.group = group, .side = left ? 1.0 : -1.0, .held_mm = held_mm};
    hand.size = sim_random_between(random, 0.86, 1.1);
    hand.spread = sim_random_between(random, 0.3, 1.5);
    hand.curl_rad = sim_random_between(random, 0.02, 0.35);
    if (pose == SIM_HAND_OPEN) {
        add_open(&hand);
    } else if (pose == SIM_HAND_FIST) {
        add_fist(&hand);
    } else {
        add_grip(&hand);
    }
    add_forearm(&hand, random);
}
