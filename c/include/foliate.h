/* Foliate: manipulation planning. Made by cbindgen of c/src; `FOLIATE_HEADER=write cargo test -p foliate_c` makes it again. */

#ifndef FOLIATE_H
#define FOLIATE_H

#include <stddef.h>
#include <stdint.h>

// What `improve_work` is for the default budget.
#define FOLIATE_IMPROVE_DEFAULT UINT64_MAX

// How a call ended. `foliate_error` says it in words.
typedef enum FoliateStatus {
  // It did what was asked.
  FOLIATE_STATUS_OK = 0,
  // The search ended without a path: at its deadline or at a limit.
  FOLIATE_STATUS_NO_SOLUTION = 1,
  // A file or a text cannot be read, or has no meaning as a scene.
  FOLIATE_STATUS_UNREADABLE = 2,
  // The start or the goals are infeasible, or no path can exist.
  FOLIATE_STATUS_INFEASIBLE = 3,
  // `foliate_cancel` ended the search.
  FOLIATE_STATUS_CANCELLED = 4,
  // An argument is wrong: a null pointer, text that is not UTF-8, a name or a number that does not exist.
  FOLIATE_STATUS_ARGUMENT = 5,
  // A file cannot be written.
  FOLIATE_STATUS_UNWRITABLE = 6,
  // A bug of Foliate. The process may go on.
  FOLIATE_STATUS_BUG = 7,
} FoliateStatus;

// What a hand does.
typedef enum FoliateEventKind {
  // It closes about an object.
  FOLIATE_EVENT_KIND_GRASP = 0,
  // It opens.
  FOLIATE_EVENT_KIND_RELEASE = 1,
} FoliateEventKind;

// What a check found.
typedef enum FoliateVerdict {
  // Everything is proved, against a scene.
  FOLIATE_VERDICT_PROVED = 0,
  // A promise is broken.
  FOLIATE_VERDICT_REFUSED = 1,
  // Proved, but only relative to what the file says of itself.
  FOLIATE_VERDICT_RELATIVE = 3,
  // The limits ended the check before that.
  FOLIATE_VERDICT_UNDECIDED = 4,
} FoliateVerdict;

// Ends solves from another thread.
typedef struct FoliateCancel FoliateCancel;

// A certified path with times.
typedef struct FoliatePath FoliatePath;

// A scene. Calls that only read it may come from several threads at once.
typedef struct FoliateScene FoliateScene;

// How a scene is solved. `foliate_options_default` fills it.
typedef struct FoliateOptions {
  // Same seed, same answer, on any number of threads. Default: 1.
  uint64_t seed;
  // Seconds. Default: 60.
  double time_limit;
  // Threads of one search. Default: 1.
  uint32_t threads;
  // Counted work that is spent on a better path than the first; 0: the first path with times. Default: `FOLIATE_IMPROVE_DEFAULT`, as `foliate solve`.
  uint64_t improve_work;
  // Name of a scheduler; null: the default one.
  const char *scheduler;
} FoliateOptions;

// A motion on one leaf. The texts belong to the path.
typedef struct FoliateSegment {
  // Name of the state in which it lies.
  const char *state;
  // Name of the transition that is travelled.
  const char *transition;
  // When it begins, seconds.
  double begin;
  // When it ends, seconds.
  double end;
} FoliateSegment;

// A hand takes or lets go of an object. The texts belong to the path.
typedef struct FoliateEvent {
  // Seconds.
  double time;
  // How long the robot stands still then, seconds.
  double dwell;
  // What it does.
  enum FoliateEventKind kind;
  // The part that is taken or let go.
  const char *object;
  // `part/gripper`.
  const char *gripper;
  // `part/handle`.
  const char *handle;
} FoliateEvent;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// What was wrong with the last call of this thread that returned a status: with file, line and hint where there are some. Empty after `FOLIATE_STATUS_OK`.
// The text belongs to Foliate and is there until the next call of this thread.
const char *foliate_error(void);

// Foliate's version, such as `0.1.0`.
const char *foliate_version(void);

// Loads a scene: a shipped one by its name (`demo`), or a file. `packages` are folders in which `package://` names are looked up.
//
// # Safety
// `name` is a text; `packages` has `package_count` texts; `out` can be written.
enum FoliateStatus foliate_scene_load(const char *name, const char *const *packages, size_t package_count, struct FoliateScene **out);

// Reads a scene from the text of a scene file. Names of files in it start at `folder`.
//
// # Safety
// `toml` and `folder` are texts; `packages` has `package_count` texts; `out` can be written.
enum FoliateStatus foliate_scene_from_text(const char *toml,
                                           const char *folder,
                                           const char *const *packages,
                                           size_t package_count,
                                           struct FoliateScene **out);

// Frees a scene. Null is nothing to free.
//
// # Safety
// `scene` is null or came from this interface, and is not used again.
void foliate_scene_free(struct FoliateScene *scene);

// Sets where a joint (`part/joint`) or a part starts. A joint has one number (rad or m), a base on the floor three (x, y, angle), a part seven: x, y, z in metres and the quaternion x, y, z, w,
// in the world.
//
// # Safety
// `scene` came from this interface and is not used elsewhere during the call; `name` is a text; `values` has `count` numbers.
enum FoliateStatus foliate_scene_set_start(struct FoliateScene *scene,
                                           const char *name,
                                           const double *values,
                                           size_t count);

// Sets the goal: each of `count` joints or parts has its values in the end, as in `foliate_scene_set_start`. What is not named is free, but nothing stays in a hand. Goals that the scene had are gone.
//
// # Safety
// `scene` as in `foliate_scene_set_start`; `names` has `count` texts, `values` as many arrays, `value_counts` how many numbers each of them has.
enum FoliateStatus foliate_scene_set_goal(struct FoliateScene *scene,
                                          const char *const *names,
                                          const double *const *values,
                                          const size_t *value_counts,
                                          size_t count);

// What a joint or part has at the start, into `values`, which has room for `capacity` numbers; `count` becomes how many there are.
//
// # Safety
// `scene` came from this interface; `name` is a text; `values` has room for `capacity` numbers; `count` can be written.
enum FoliateStatus foliate_scene_start(const struct FoliateScene *scene, const char *name, double *values, size_t capacity, size_t *count);

// The default options.
struct FoliateOptions foliate_options_default(void);

// Makes one. `foliate_cancel_free` frees it.
struct FoliateCancel *foliate_cancel_new(void);

// Ends the solves that have been given this, and those that will be. May be called from any thread and from a handler of signals.
//
// # Safety
// `cancel` is null or came from `foliate_cancel_new` and is not freed.
void foliate_cancel(const struct FoliateCancel *cancel);

// Frees it. Null is nothing to free.
//
// # Safety
// `cancel` is null or came from `foliate_cancel_new`, no solve has it any more, and it is not used again.
void foliate_cancel_free(struct FoliateCancel *cancel);

// Plans a path. `options` may be null (the default ones), `cancel` too (nothing ends it but its limit). `out` becomes a path with times; `foliate_path_free` frees it.
//
// # Safety
// `scene` came from this interface and does not change meanwhile; `options` and `cancel` are null or can be read; `out` can be written.
enum FoliateStatus foliate_solve(const struct FoliateScene *scene,
                                 const struct FoliateOptions *options,
                                 const struct FoliateCancel *cancel,
                                 struct FoliatePath **out);

// Frees a path. Null is nothing to free.
//
// # Safety
// `path` is null or came from this interface, and is not used again.
void foliate_path_free(struct FoliatePath *path);

// How long a path takes, seconds; 0 of null.
//
// # Safety
// `path` is null or came from this interface.
double foliate_path_duration(const struct FoliatePath *path);

// How many joints of one coordinate all robots have, those that follow others included; 0 of null.
//
// # Safety
// `path` is null or came from this interface.
size_t foliate_path_joint_count(const struct FoliatePath *path);

// Name of a joint, `part/joint`; null where there is none. The text belongs to the path.
//
// # Safety
// `path` is null or came from this interface.
const char *foliate_path_joint_name(const struct FoliatePath *path, size_t index);

// What the joints do at times (seconds; clamped to the path): rows of `foliate_path_joint_count` numbers, a row for each time; rad, rad/s, rad/s² or metres. `velocities` and `accelerations` may be null.
//
// # Safety
// `path` came from this interface; `times` has `count` numbers; the others are null or have room for `count` rows.
enum FoliateStatus foliate_path_sample(const struct FoliatePath *path,
                                       const double *times,
                                       size_t count,
                                       double *positions,
                                       double *velocities,
                                       double *accelerations);

// The pose in the world of a link (`part/link`) or a part (its root link) at a time: x, y, z in metres and the quaternion x, y, z, w, into seven numbers.
//
// # Safety
// `path` came from this interface; `name` is a text; `pose` has room for seven numbers.
enum FoliateStatus foliate_path_pose(const struct FoliatePath *path,
                                     const char *name,
                                     double time,
                                     double *pose);

// How many segments a path has; 0 of null.
//
// # Safety
// `path` is null or came from this interface.
size_t foliate_path_segment_count(const struct FoliatePath *path);

// A segment, in the direction of travel.
//
// # Safety
// `path` came from this interface; `out` can be written.
enum FoliateStatus foliate_path_segment(const struct FoliatePath *path, size_t index, struct FoliateSegment *out);

// How often hands take or let go; 0 of null.
//
// # Safety
// `path` is null or came from this interface.
size_t foliate_path_event_count(const struct FoliatePath *path);

// An event, in the order of time.
//
// # Safety
// `path` came from this interface; `out` can be written.
enum FoliateStatus foliate_path_event(const struct FoliatePath *path, size_t index, struct FoliateEvent *out);

// Writes the path file, which `foliate_check` and the program `foliate` read.
//
// # Safety
// `path` came from this interface; `file` is a text.
enum FoliateStatus foliate_path_save(const struct FoliatePath *path, const char *file);

// Proves a path file over the continuum, by code that shares nothing with the search. `scene` is what it has to answer, a shipped scene's name or a file; null: the scene that the file names.
// `time_limit` is in seconds. Where the verdict is not `FOLIATE_VERDICT_PROVED`, `foliate_error` says what was found.
//
// # Safety
// `file` is a text, `scene` is null or one; `packages` has `package_count` texts; `out` can be written.
enum FoliateStatus foliate_check(const char *file,
                                 const char *scene,
                                 const char *const *packages,
                                 size_t package_count,
                                 double time_limit,
                                 enum FoliateVerdict *out);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FOLIATE_H */
