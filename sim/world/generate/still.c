#include "sim/world/generate/still.h"

#include "sim/world/face/expression.h"

int sim_still_init(struct sim_still *still, bool wall, struct sim_random *random)
{
    struct sim_still made = {0};
    int error = sim_group_new(&made.things);
    if (error == 0 && wall) {
        error = sim_room_new(false, random, &made.room);
    }
    if (error != 0) {
        sim_still_done(&made);
        return error;
    }
    *still = made;
    return 0;
}

void sim_still_done(struct sim_still *still)
{
    sim_room_free(still->room);
    sim_group_free(still->things);
    sim_sitter_free(still->person);
    *still = (struct sim_still){0};
}

int sim_still_add_person(struct sim_still *still, const struct sim_ict *ict, const char *crowd,
                         bool hair, const struct sim_stance *stance, struct sim_random *random)
{
    struct sim_person person = sim_person_draw(crowd, sim_random_u64(random), 0, 1.0);
    struct sim_sitter_options options = {.hair = hair, .torso = true};
    still->stance = *stance;
    (void)sim_expression_draw(ict, SIM_NEUTRAL, random, still->stance.expression);
    return sim_sitter_new(ict, &person, &options, random, &still->person);
}

int sim_still_draw(void *scene, int frame, struct sim_view *view, struct sim_truth *truth,
                   bool *truth_known)
{
    struct sim_still *still = scene;
    struct iso_rigid here = iso_rigid_identity();
    (void)frame;
    (void)truth;
    *truth_known = false;
    int error = still->room ? sim_room_draw(still->room, view) : 0;
    if (error == 0 && still->person) {
        error = sim_sitter_draw(still->person, &still->stance, view, NULL);
    }
    return error == 0 ? sim_group_draw(still->things, &here, view) : error;
}
