/* Hair: a shell over the scalp, and for long hair a curtain that hangs beside and behind the face.
 *
 * To a depth sensor hair is a rough surface some way off the skin, that covers forehead, temples
 * and ears more or less, differs between people and changes a little between sessions. Nothing else
 * is modelled. */
#ifndef SIM_WORLD_PROP_HAIR_H
#define SIM_WORLD_PROP_HAIR_H

#include <stdbool.h>
#include <stdint.h>

#include "sim/base/random.h"
#include "sim/world/face/ict.h"
#include "sim/world/prop/solid.h"

struct sim_hair {
    bool scalp, curtain;  /* neither: a bald head */
    double thickness_mm;  /* of the shell */
    double hairline_mm;   /* how much lower than usual it begins (a fringe: about 30) */
    double curtain_front; /* how far the curtain comes round the side of the face, radians from the
                             ear */
    uint64_t key;         /* of the shell's bumps */
};

/* The hair of a person: about 1 in 12 bald, 1 in 4 long, 1 in 5 with a fringe. */
struct sim_hair sim_hair_of_person(uint64_t person_key);

/* The same hair on another day. */
struct sim_hair sim_hair_of_session(const struct sim_hair *hair, struct sim_random *random);

/* The shell in the face frame, for a head whose neutral surface is `vertices_mm`
 * (sim_person_surface). -EINVAL if there is no such part of the hair, -ENOMEM. */
int sim_hair_scalp(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                   const struct sim_hair *hair, struct sim_solid **out)
    __attribute__((warn_unused_result));

/* The curtain likewise. */
int sim_hair_curtain(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                     const struct sim_hair *hair, struct sim_solid **out)
    __attribute__((warn_unused_result));

#endif
