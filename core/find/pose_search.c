#include "core/find/pose_search.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>

/* How many poses go from one round to the next. At first the best OF_A_CANDIDATE poses of each
 * candidate are kept, so that near copies of one wrong pose do not displace all others. The later
 * rounds keep the best poses of all. */
enum { OTHERS = 4, OF_A_CANDIDATE = 2, FINALISTS = 16, REFINED = 8, FITTED = 4 };

/* Vertices that the first round compares. */
enum { ROUGH_VERTICES = 110 };

/* A candidate that stands out less is not tried (ring_height.h). Of 1,000 faces in rendered and
 * real frames, turned and far ones among them, none was found from a candidate that stands out by
 * less than 36 mm. Most bumps of walls, floors and clothes stand out by less than 20 mm. */
static const double stands_out_min_mm = 24.0;

/* Faces turned further than this are not looked for. */
static const double turned_max_rad = 1.05;
static const double upright_cosine_min = 0.5;
/* The cost of a turned face, by the square of its angle: of two fits that are equally good, the
 * frontal one is taken. It is large in the first round, where the mean face fits chairs, shoulders
 * and hair best when it is turned. In the later rounds it is smaller: with 5 mm2, frontal fits were
 * taken for some turned heads; with 1.5 mm2, the back of a head was taken for a covered face. */
static const double turned_rough_cost_mm2 = 5.0, turned_cost_mm2 = 2.0;
/* What is added to turned_cost_mm2 in the decision whether there is a face at all. */
static const double turned_doubt_mm2 = 3.0;

/* A fit this good is certainly a face; parts of the scene behind it are not searched. */
static const double beyond_doubt_mm2 = 6.0;
/* A second face counts if at least this share of it is measured and in the image, if its nose is at
 * least this far from the first one, and if it is at most this many times as far away. */
static const double other_coverage_min = 0.8;
static const double other_apart_mm = 110.0, other_far_ratio = 1.2;
/* Bounds of the rigid cost of a pose, from 3,400 searches in rendered and real frames. They decide
 * which poses are fitted.
 *
 * After a fit beyond doubt, a pose is fitted only if its cost is at most this much above the least
 * cost. Without this bound, 16 searches found a slightly better fit of the same face. */
static const double hopeless_mm2 = 6.0;
/* The rigid cost of a second face is at most this. Of 2,963 faces 3 cost more, all of them in
 * images of attacks. */
static const double rigid_face_mm2 = 16.0;
/* A pose that costs more is not fitted. Every face was found from a pose that cost 20.5 mm2 or
 * less. */
static const double rigid_most_mm2 = 23.0;
/* A nearer fit gives way to one that is better by more than this. */
static const double much_worse_mm2 = 4.0;

static const double yaws_rad[3] = {0.0, -0.55, 0.55};
static const double pitches_rad[3] = {0.0, -0.35, 0.35};

/* The best rough poses of a candidate, by rising cost. */
struct rough_poses {
    int n;
    struct iso_pose_fit fit[OF_A_CANDIDATE];
};

/* The best poses so far, by rising cost. */
struct ranking {
    int n, room; /* room <= FINALISTS */
    struct iso_pose_fit fit[FINALISTS];
};

static void rank_insert(struct ranking *ranking, const struct iso_pose_fit *fit)
{
    int at = ranking->n < ranking->room ? ranking->n++ : ranking->room;
    for (; at > 0 && ranking->fit[at - 1].cost_mm2 > fit->cost_mm2; at--) {
        if (at < ranking->room) {
            ranking->fit[at] = ranking->fit[at - 1];
        }
    }
    if (at < ranking->room) {
        ranking->fit[at] = *fit;
    }
}

/* A face that looks into the camera, turned by yaw and pitch, its nose tip at a point. */
static struct iso_rigid posed_at(struct iso_vec3 nose_mm, double yaw_rad, double pitch_rad)
{
    struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, yaw_rad, 0));
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(pitch_rad, 0, 0));
    struct iso_mat3 turned = iso_mat3_mul(&yaw, &pitch);
    return (struct iso_rigid){iso_mat3_mul(&facing, &turned), nose_mm};
}

/* The angle by which a face is turned away from the camera. Its roll does not count. */
static double turned_rad(const struct iso_frame *frame, const struct iso_rigid *pose)
{
    const struct iso_mat3 *r = &pose->rotation;
    const struct iso_vec3 forward = {r->m[0][2], r->m[1][2], r->m[2][2]};
    const struct iso_vec3 sight = frame->camera.projection == ISO_PINHOLE
                                      ? iso_unit(pose->translation_mm)
                                      : iso_vec3(0, 0, 1);
    return acos(fmin(fmax(-iso_dot(forward, sight), -1.0), 1.0));
}

/* Makes costs comparable. A fit must not look good because measurements are missing, or because
 * most of the face is turned out of sight. Returns false for attitudes in which no face can be
 * recognised, and for faces upside down. */
static bool weigh_up(const struct iso_pose_search *search, double turned_mm2,
                     struct iso_pose_fit *fit)
{
    const double turned = turned_rad(search->frame, &fit->camera_from_face);
    if (turned > turned_max_rad || -fit->camera_from_face.rotation.m[1][1] < upright_cosine_min) {
        return false;
    }
    fit->cost_mm2 += ISO_POSE_COST_LIMIT_MM2 * fmax(search->coverage_min - fit->coverage, 0.0);
    fit->cost_mm2 += turned_mm2 * turned * turned;
    return true;
}

/* The cost by which a fit of the later rounds is a face, or none. */
static double doubt_mm2(const struct iso_pose_search *search, const struct iso_pose_fit *fit)
{
    const double turned = turned_rad(search->frame, &fit->camera_from_face);
    return fit->cost_mm2 + turned_doubt_mm2 * turned * turned;
}

/* Registers the mean face roughly with its nose tip at a candidate, from nine attitudes. */
static struct rough_poses try_candidate(const struct iso_pose_search *search,
                                        const struct iso_nose_candidate *candidate)
{
    const struct iso_vec3 nose_mm = candidate->point_mm;
    const struct iso_pose_options rough = {
        .iterations = 3,
        .vertices = ROUGH_VERTICES,
        .cutoff_first_mm = 35.0,
        .cutoff_last_mm = 20.0,
        .nose_sigma_mm = 8.0,
        .nose_mm = nose_mm,
    };
    struct ranking best = {.room = OF_A_CANDIDATE};
    if (candidate->stands_out_mm < stands_out_min_mm) {
        return (struct rough_poses){.n = 0};
    }
    for (int y = 0; y < 3; y++) {
        for (int p = 0; p < 3; p++) {
            struct iso_rigid start = posed_at(nose_mm, yaws_rad[y], pitches_rad[p]);
            struct iso_pose_fit fit;
            if (iso_pose_fit(search->vertices, search->frame, &rough, &start, &fit) == 0 &&
                weigh_up(search, turned_rough_cost_mm2, &fit)) {
                rank_insert(&best, &fit);
            }
        }
    }
    struct rough_poses poses = {.n = best.n};
    for (int i = 0; i < best.n; i++) {
        poses.fit[i] = best.fit[i];
    }
    return poses;
}

/* Whether two poses are so close that further steps would make them the same. */
static bool much_alike(const struct iso_rigid *a, const struct iso_rigid *b)
{
    struct iso_mat3 bt = iso_mat3_transpose(&b->rotation);
    const struct iso_mat3 between = iso_mat3_mul(&bt, &a->rotation);
    double trace = between.m[0][0] + between.m[1][1] + between.m[2][2];
    const double apart_mm = iso_norm(iso_sub(a->translation_mm, b->translation_mm));
    return apart_mm < 6.0 && trace > 1.0 + 2.0 * cos(0.15);
}

/* Continues the fit of every pose of a ranking, and keeps the best ones that differ. */
static struct ranking refine_ranking(const struct iso_pose_search *search,
                                     const struct ranking *from,
                                     const struct iso_pose_options *options, int room)
{
    struct ranking refined = {.room = room};
    for (int i = 0; i < from->n; i++) {
        struct iso_pose_fit fit;
        const struct iso_rigid *start = &from->fit[i].camera_from_face;
        if (iso_pose_fit(search->vertices, search->frame, options, start, &fit) ||
            !weigh_up(search, turned_cost_mm2, &fit)) {
            continue;
        }
        bool known = false;
        for (int k = 0; k < refined.n && !known; k++) {
            known = much_alike(&fit.camera_from_face, &refined.fit[k].camera_from_face);
        }
        if (!known) {
            rank_insert(&refined, &fit);
        }
    }
    return refined;
}

/* Fits the whole head model from each of the best few poses whose rigid cost is at most
 * most_mm2, and takes the best fit. The rigid mean face alone is misled by people who are far
 * from the mean. Returns false if no fit succeeds. */
static bool best_of(const struct iso_pose_search *search, const struct ranking *finalists,
                    double most_mm2, struct iso_pose_fit *best)
{
    const struct iso_pose_options middle = {
        .iterations = 5, .cutoff_first_mm = 20.0, .cutoff_last_mm = 12.0};
    const struct iso_pose_options fine = {
        .iterations = 6, .cutoff_first_mm = 12.0, .cutoff_last_mm = 8.0};
    struct ranking settled = refine_ranking(search, finalists, &middle, REFINED);
    struct ranking refined = refine_ranking(search, &settled, &fine, FITTED);
    bool found = false;
    for (int i = 0; i < refined.n && refined.fit[i].cost_mm2 <= most_mm2; i++) {
        struct iso_pose_fit fit;
        if (found && refined.fit[i].cost_mm2 > refined.fit[0].cost_mm2 + hopeless_mm2 &&
            doubt_mm2(search, best) <= beyond_doubt_mm2) {
            break; /* the others are still worse */
        }
        if (iso_shape_fit_pose(search->fitter, search->frame, &refined.fit[i].camera_from_face,
                               &fit) ||
            !weigh_up(search, turned_cost_mm2, &fit)) {
            continue;
        }
        if (!found || fit.cost_mm2 < best->cost_mm2) {
            *best = fit;
            found = true;
        }
    }
    return found;
}

/* Chooses among fits to parts of the scene, sorted from near to far: the nearest fit that is not
 * much worse than the best one. A shoulder in front of a face fits the mean face too, but badly.
 * NULL if no fit is good enough. */
static const struct iso_pose_fit *nearest_good(const struct iso_pose_search *search,
                                               const struct iso_pose_fit *fits, int n)
{
    double limit = INFINITY;
    for (int i = 0; i < n; i++) {
        limit = fmin(limit, fits[i].cost_mm2 + much_worse_mm2);
    }
    for (int i = 0; i < n; i++) {
        if (fits[i].cost_mm2 <= limit && doubt_mm2(search, &fits[i]) <= search->cost_max_mm2) {
            return &fits[i];
        }
    }
    return NULL;
}

/* Whether the rough poses of other noses at about the same distance lead to a face as well. */
static bool another_face(const struct iso_pose_search *search, const struct rough_poses *rough,
                         int n, const struct iso_pose_fit *found)
{
    const struct iso_vec3 nose_mm = found->camera_from_face.translation_mm;
    struct ranking others = {.room = OTHERS};
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < rough[i].n; k++) {
            struct iso_vec3 at_mm = rough[i].fit[k].camera_from_face.translation_mm;
            if (iso_norm(iso_sub(at_mm, nose_mm)) > other_apart_mm &&
                at_mm.z < other_far_ratio * nose_mm.z) {
                rank_insert(&others, &rough[i].fit[k]);
            }
        }
    }
    struct iso_pose_fit other;
    if (others.n == 0 || !best_of(search, &others, rigid_face_mm2, &other)) {
        return false;
    }
    const struct iso_vec3 apart = iso_sub(other.camera_from_face.translation_mm, nose_mm);
    return doubt_mm2(search, &other) <= beyond_doubt_mm2 && other.coverage >= other_coverage_min &&
           other.in_image >= other_coverage_min && iso_norm(apart) > other_apart_mm;
}

int iso_pose_search(const struct iso_pose_search *search,
                    const struct iso_nose_candidate *candidates, int n_candidates,
                    struct iso_pose_fit *out, bool *several)
{
    struct iso_pose_fit fits[ISO_CANDIDATE_PARTS_MAX];
    struct rough_poses rough[ISO_CANDIDATES_MAX];
    int n = 0, n_rough = 0;
    int i = 0;
    while (i < n_candidates && n < ISO_CANDIDATE_PARTS_MAX) {
        struct ranking finalists = {.room = FINALISTS};
        const int part = candidates[i].part;
        for (; i < n_candidates && candidates[i].part == part; i++) {
            rough[n_rough] = try_candidate(search, &candidates[i]);
            for (int k = 0; k < rough[n_rough].n; k++) {
                rank_insert(&finalists, &rough[n_rough].fit[k]);
            }
            n_rough++;
        }
        if (!best_of(search, &finalists, rigid_most_mm2, &fits[n])) {
            continue;
        }
        if (doubt_mm2(search, &fits[n++]) <= beyond_doubt_mm2) {
            break;
        }
    }
    const struct iso_pose_fit *found = nearest_good(search, fits, n);
    if (!found) {
        return -ENOENT;
    }
    /* Parts that were not searched because the face was beyond doubt may hold another face. */
    const double far_mm = other_far_ratio * found->camera_from_face.translation_mm.z;
    for (; i < n_candidates; i++) {
        if (candidates[i].point_mm.z < far_mm) {
            rough[n_rough++] = try_candidate(search, &candidates[i]);
        }
    }
    *out = *found;
    *several = another_face(search, rough, n_rough, found);
    return 0;
}
