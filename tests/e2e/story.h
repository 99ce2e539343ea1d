/* The tests of test_e2e_appliance are in several files. Each test continues from the state that the
 * test before it leaves; the table in test_appliance.c has their order. */
#ifndef TEST_E2E_STORY_H
#define TEST_E2E_STORY_H

/* Enrolment, names and recognition through the command line (story_people.c). */
void people_are_enrolled(void **state);
void a_known_face_is_refused_under_another_name(void **state);
void a_used_name_is_for_its_owner_only(void **state);
void names_are_checked(void **state);
void people_are_identified(void **state);
void people_are_verified(void **state);
void nobody_before_the_camera_times_out(void **state);

/* Hints about the scene before the camera, and clients that claim the camera (story_camera.c). */
void a_person_who_stands_badly_gets_a_hint(void **state);
void an_empty_room_gets_no_hint(void **state);
void a_room_with_a_chair_gets_no_hint(void **state);
void the_camera_can_be_aimed(void **state);
void a_camera_in_use_is_refused_and_freed_by_an_interrupt(void **state);
void a_client_that_dies_frees_the_camera(void **state);

/* Visits, the door's answer, and the log (story_door.c). */
void the_door_opens_to_the_enrolled_and_to_nobody_else(void **state);
void visits_and_grants_are_in_the_log(void **state);
void removed_and_expired_people_are_refused(void **state);
void limits_and_names_are_changed_on_record(void **state);
void a_repeated_recording_opens_nothing(void **state);

#endif
