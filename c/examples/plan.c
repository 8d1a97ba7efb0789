/* Loads a scene, moves a box at the start, plans with a deadline, reads the trajectory, saves and proves it.

       cc plan.c $(pkg-config --cflags --libs foliate) -o plan && ./plan path.json
*/
#include <foliate.h>

#include <stdio.h>
#include <stdlib.h>

static void need(FoliateStatus status) {
    if (status != FOLIATE_STATUS_OK) {
        fprintf(stderr, "status %d: %s\n", (int)status, foliate_error());
        exit(1);
    }
}

int main(int count, char **arguments) {
    const char *file = count > 1 ? arguments[1] : "path.json";
    FoliateScene *scene = NULL;
    need(foliate_scene_load("demo", NULL, 0, &scene));

    /* A box starts 5 cm further to the left. */
    double pose[7];
    size_t numbers = 0;
    need(foliate_scene_start(scene, "box1", pose, 7, &numbers));
    pose[1] += 0.05;
    need(foliate_scene_set_start(scene, "box1", pose, numbers));

    /* Mistakes are told. */
    if (foliate_scene_set_start(scene, "bax", pose, numbers) != FOLIATE_STATUS_ARGUMENT) {
        return 1;
    }
    printf("as it should be: %s\n", foliate_error());

    /* The scene's own goal is a whole configuration; here it is the place of one box. */
    const char *names[] = {"box1"};
    double goal[] = {0.5, -0.3, 0.741, 0.0, 0.0, 0.0, 1.0};
    const double *values[] = {goal};
    const size_t counts[] = {7};
    need(foliate_scene_set_goal(scene, names, values, counts, 1));

    FoliateOptions options = foliate_options_default();
    options.seed = 7;
    options.time_limit = 30.0;
    FoliateCancel *cancel = foliate_cancel_new(); /* foliate_cancel(cancel) from any thread ends the search. */
    FoliatePath *path = NULL;
    need(foliate_solve(scene, &options, cancel, &path));

    double duration = foliate_path_duration(path);
    printf("%zu segments, %.2f s\n", foliate_path_segment_count(path), duration);
    for (size_t i = 0; i < foliate_path_event_count(path); i++) {
        FoliateEvent event;
        need(foliate_path_event(path, i, &event));
        printf("%.2f s: %s %s %s\n", event.time, event.gripper, event.kind == FOLIATE_EVENT_KIND_GRASP ? "grasps" : "releases", event.handle);
    }

    /* A row every 10 ms. */
    size_t joints = foliate_path_joint_count(path), rows = (size_t)(duration / 0.01) + 1;
    double *times = malloc(rows * sizeof *times);
    double *positions = malloc(rows * joints * sizeof *positions);
    double *velocities = malloc(rows * joints * sizeof *velocities);
    if (times == NULL || positions == NULL || velocities == NULL) {
        return 1;
    }
    for (size_t row = 0; row < rows; row++) {
        times[row] = 0.01 * (double)row;
    }
    need(foliate_path_sample(path, times, rows, positions, velocities, NULL));
    for (size_t joint = 0; joint < joints && joint < 3; joint++) {
        printf("%s: from %.3f to %.3f rad\n", foliate_path_joint_name(path, joint), positions[joint], positions[(rows - 1) * joints + joint]);
    }
    need(foliate_path_pose(path, "box1", duration, pose));
    printf("box1 ends at %.3f %.3f %.3f\n", pose[0], pose[1], pose[2]);

    need(foliate_path_save(path, file));
    FoliateVerdict verdict;
    /* The start and the goal were set here, so that no scene file says what the path has to answer. */
    need(foliate_check(file, NULL, NULL, 0, 60.0, &verdict));
    printf("verdict %d\n", (int)verdict);

    free(times);
    free(positions);
    free(velocities);
    foliate_path_free(path);
    foliate_cancel_free(cancel);
    foliate_scene_free(scene);
    return verdict == FOLIATE_VERDICT_PROVED || verdict == FOLIATE_VERDICT_RELATIVE ? 0 : 1;
}
