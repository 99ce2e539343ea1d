/* Hair: a shell over the scalp and, for long hair, a curtain that hangs beside and behind the face.
 *
 * To a depth sensor, hair is a rough surface at some distance from the skin. It covers parts of
 * forehead, temples and ears, differs between people and changes a little between sessions. No
 * other property is modelled. */
#ifndef SIM_WORLD_PROP_HAIR_H
#define SIM_WORLD_PROP_HAIR_H

#include <stdbool.h>
#include <stdint.h>

#include "sim/base/random.h"
#include "sim/world/face/ict.h"
#include "sim/world/prop/solid.h"

struct sim_hair {
    bool scalp, curtain;  /* both false: a bald head */
    double thickness_mm;  /* of the shell */
    double hairline_mm;   /* how far the hairline is below its usual place (a fringe: about 30) */
    double curtain_front; /* how far the curtain reaches round the side of the face, radians from
                             the ear */
    uint64_t key;         /* of the shell's bumps */
};

/* The hair of a person: about 1 in 12 bald, 1 in 4 long, 1 in 5 with a fringe. */
struct sim_hair sim_hair_of_person(uint64_t person_key);

/* The same person's hair on another day. */
struct sim_hair sim_hair_of_session(const struct sim_hair *hair, struct sim_random *random);

/* Hair that stays as it is between visits, because people keep their haircut and comb it in the
 * same way. About 1 in 12 people is bald, 1 in 2 has long hair that reaches farther over the
 * cheeks, and 1 in 2 has a fringe, which may reach down to the eyebrows. The same key gives the
 * same hair, with the same bumps. */
struct sim_hair sim_hair_kept(uint64_t person_key);

/* The kept hair on another day: it has the same bumps, and its thickness, its hairline and the
 * reach of its curtain differ a little. */
struct sim_hair sim_hair_kept_today(const struct sim_hair *hair, struct sim_random *random);

/* The shell in the face frame, for a head whose neutral surface is `vertices_mm`
 * (sim_person_surface). -EINVAL if this hair has no shell, -ENOMEM. */
int sim_hair_scalp(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                   const struct sim_hair *hair, struct sim_solid **out)
    __attribute__((warn_unused_result));

/* The curtain in the same way; -EINVAL if this hair has none. */
int sim_hair_curtain(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                     const struct sim_hair *hair, struct sim_solid **out)
    __attribute__((warn_unused_result));

#endif
