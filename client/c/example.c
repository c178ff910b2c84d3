/* Plays a match: joins a server, says what the scene's script says, counts what it sees, leaves
 * when the server ends the match. A second world beside it, without a network, checks one thing
 * that holds for every client: the same inputs give the same bits.
 *
 *   example HOST PORT SCENE [PREDICT_TICKS]
 *
 * Prints "tick T digest D ..." at the end. Exit 0: played to the end without a mismatch. */
#include <cycloid.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static int give_up(const char* what) {
  char text[256];
  cycloid_last_error(text, sizeof text);
  fprintf(stderr, "%s: %s\n", what, text);
  return 5;
}

/* Steps ten ticks twice from one saved state. */
static int check_offline(const char* scene) {
  cycloid_simulation* world = NULL;
  cycloid_saved* start = NULL;
  cycloid_input inputs[256];
  uint64_t digests[2] = {0, 0};
  if (cycloid_simulation_create(scene, &world) != CYCLOID_OK) return give_up(scene);
  const uint32_t seats = cycloid_simulation_seats(world);
  if (cycloid_simulation_save(world, &start) != CYCLOID_OK) return give_up("save");
  for (int run = 0; run < 2; ++run) {
    if (cycloid_simulation_restore(world, start) != CYCLOID_OK) return give_up("restore");
    for (uint64_t tick = 1; tick <= 10; ++tick) {
      for (uint32_t seat = 0; seat < seats; ++seat) {
        inputs[seat].struct_bytes = sizeof inputs[seat];
        cycloid_simulation_scripted_input(world, seat, tick, &inputs[seat]);
      }
      if (cycloid_simulation_step(world, inputs, seats) != CYCLOID_OK) return give_up("step");
    }
    digests[run] = cycloid_simulation_digest(world);
  }
  cycloid_saved_destroy(start);
  cycloid_simulation_destroy(world);
  return digests[0] == digests[1] ? 0 : 1;
}

static uint32_t count_events(cycloid_client* client, uint32_t* joins) {
  cycloid_event events[64];
  uint32_t count = 0;
  uint32_t all = 0;
  do {
    if (cycloid_client_read_events(client, events, 64, &count) != CYCLOID_OK) return all;
    for (uint32_t i = 0; i < count; ++i) *joins += events[i].kind == CYCLOID_EVENT_JOIN ? 1u : 0u;
    all += count;
  } while (count == 64);
  return all;
}

static int play(const cycloid_client_options* options) {
  cycloid_client* client = NULL;
  cycloid_client_state state = {.struct_bytes = sizeof state};
  cycloid_pose* poses = NULL;
  uint32_t pose_count = 0;
  uint32_t events = 0;
  uint32_t joins = 0;
  char reason[256];
  if (cycloid_client_create(options, &client) != CYCLOID_OK) return give_up("create");
  if (cycloid_client_connect(client) != CYCLOID_OK) return give_up("connect");
  do {
    if (cycloid_client_poll(client, 50) != CYCLOID_OK) return give_up("poll");
    if (cycloid_client_read_state(client, &state) != CYCLOID_OK) return give_up("state");
    events += count_events(client, &joins);
    /* An engine would draw these, at the time of its own clock: here half a tick ago. */
    const double shown = (double)state.predicted_tick - 0.5;
    if (cycloid_client_read_poses_at(client, shown, poses, pose_count, &pose_count) ==
        CYCLOID_BUFFER) {
      cycloid_pose* more = realloc(poses, pose_count * sizeof *poses);
      if (more == NULL) return 5;
      poses = more;
    }
  } while (state.phase != CYCLOID_PHASE_OVER);
  cycloid_client_reason(client, reason, sizeof reason);
  printf("tick %" PRIu64 " digest %016" PRIx64 " seat %d bodies %u events %u joins %u rollbacks %"
         PRIu64 " mismatches %" PRIu64 " end %u: %s\n",
         state.tick, state.digest, (int)state.seat, pose_count, events, joins, state.rollbacks,
         state.mismatches, state.end, reason);
  free(poses);
  cycloid_client_destroy(client);
  if (state.mismatches != 0) return 1;
  return state.end == CYCLOID_END_BYE || state.end == CYCLOID_END_TICKS ? 0 : 5;
}

int main(int argc, char** argv) {
  if (argc < 4) {
    fprintf(stderr, "usage: example HOST PORT SCENE [PREDICT_TICKS]\n");
    return 2;
  }
  cycloid_client_options options = {.struct_bytes = sizeof options};
  if (cycloid_client_options_init(&options) != CYCLOID_OK) return give_up("options");
  options.host = argv[1];
  options.port = (uint32_t)strtoul(argv[2], NULL, 10);
  options.scene = argv[3];
  options.name = "C example";
  options.scripted = 1;
  if (argc > 4) options.predict_ticks = (uint32_t)strtoul(argv[4], NULL, 10);
  const int offline = check_offline(options.scene);
  return offline != 0 ? offline : play(&options);
}
