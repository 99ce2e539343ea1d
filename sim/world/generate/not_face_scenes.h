/* Scenes without a face to recognise, one function for each kind. */
#ifndef SIM_WORLD_GENERATE_NOT_FACE_SCENES_H
#define SIM_WORLD_GENERATE_NOT_FACE_SCENES_H

#include "sim/world/generate/staging.h"

/* People: from behind, turned by 80 to 110 degrees, an ear close to the sensor, and a hood seen
 * from the side or from behind. */
sim_staging_build sim_not_face_back, sim_not_face_profile, sim_not_face_ear, sim_not_face_hood;

/* Hands held up: palm, back of the hand or fist; one or two. */
sim_staging_build sim_not_face_hand;

/* A wall 0.5 to 1.2 m away (farther for a sensor that cannot see so near): plain, slanted, with a
 * rail, with a picture frame, an inner or an outer corner. For a scene without a wall of its own.
 */
sim_staging_build sim_not_face_wall;

/* Things: a ball or balloon of 60 to 150 mm radius, the back of a chair, a coat on a hanger or a
 * dummy without a head, a plant in a pot, a cushion. */
sim_staging_build sim_not_face_ball, sim_not_face_chair, sim_not_face_coat, sim_not_face_plant,
    sim_not_face_cushion;

#endif
