#include <mpi.h>
#include <signal.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/hash.h"
#include "mpi/message.h"

typedef struct {
    char host[HOST_MAX], version[CLUSTER_VERSION_MAX];
    uint64_t arguments; /* hash of the command line */
} Hello;

void host_name(char host[HOST_MAX])
{
    memset(host, 0, HOST_MAX);
    gethostname(host, HOST_MAX - 1);
}

/* The rank of this process, of n. */
static int rank_of(int *n)
{
    int rank;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, n);
    return rank;
}

Status cluster_join(int *argc, char ***argv, const char version[CLUSTER_VERSION_MAX], ReopenFn reopen, int *serves,
                    Err *err)
{
    /* 1. Launchers signal every rank: rank 0 alone decides what a signal means. */
    static const int SIGNALS[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2};
    Hello mine = {.arguments = HASH_SEED};
    Status status = STATUS_OK;
    int level, n;
    MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level);
    *serves = rank_of(&n) > 0;
    for (size_t i = 0; *serves && i < N_OF(SIGNALS); i++)
        signal(SIGNALS[i], SIG_IGN);

    /* 2. Every rank compares what all say of themselves, so that all come to one verdict, whose reason is rank 0's to
     * tell. */
    Hello *all = calloc(n, sizeof *all);
    if (!all)
        MPI_Abort(MPI_COMM_WORLD, status_exit_code(STATUS_NO_MEMORY));
    host_name(mine.host);
    memcpy(mine.version, version, sizeof mine.version);
    for (int i = 1; i < *argc; i++)
        mine.arguments = hash_fnv1a((*argv)[i], strlen((*argv)[i]) + 1, mine.arguments);
    MPI_Allgather(&mine, sizeof mine, MPI_BYTE, all, sizeof mine, MPI_BYTE, MPI_COMM_WORLD);
    for (int i = 1; i < n && status == STATUS_OK; i++)
        if (memcmp(all[i].version, all->version, sizeof all->version) != 0)
            status = bad_data(err, "rank %d on %s is imtet %s, rank 0 on %s is %s: all ranks must be one program", i,
                              all[i].host, all[i].version, all->host, all->version);
        else if (all[i].arguments != all->arguments)
            status =
                bad_data(err, "rank %d on %s has another command line than rank 0: all must have one", i, all[i].host);
    free(all);
    if (status == STATUS_OK && level < MPI_THREAD_SERIALIZED)
        status = fail(err, STATUS_INTERNAL, "this MPI cannot be called by one thread after the other");
    if (status != STATUS_OK) {
        MPI_Finalize();
        return *serves ? STATUS_OK : status;
    }
    return *serves ? serve(reopen, err) : STATUS_OK;
}

/* For every rank to say that it has left. */
static const double LEAVE_S = 5.0;

int message_receive(int from, int tag, Message *m)
{
    MPI_Message message;
    MPI_Status about;
    int there = 0, n;
    for (int tries = 0; tries < 2 && !there; tries++) /* the first may only have it come in */
        MPI_Improbe(from, tag, MPI_COMM_WORLD, &there, &message, &about);
    if (!there)
        return 0;
    MPI_Get_count(&about, MPI_BYTE, &n);
    *m = (Message){about.MPI_SOURCE, about.MPI_TAG, n, malloc((size_t)n + 1)};
    if (!m->bytes)
        MPI_Abort(MPI_COMM_WORLD, status_exit_code(STATUS_NO_MEMORY));
    MPI_Mrecv(m->bytes, n, MPI_BYTE, &message, &about);
    return 1;
}

/* Rank 0 lets all others end, and drops what still comes until every rank has left; where one does not, or a rank
 * failed, the whole job is aborted. */
void cluster_leave(int exit_code)
{
    int is_over, n, is_whole = exit_code == 0;
    MPI_Finalized(&is_over);
    if (is_over)
        return;
    if (rank_of(&n) == 0) {
        int n_left = n - 1;
        for (int i = 1; i < n; i++)
            MPI_Send(NULL, 0, MPI_BYTE, i, TAG_OPEN, MPI_COMM_WORLD);
        for (const double give_up = clock_seconds() + LEAVE_S; n_left > 0 && clock_seconds() < give_up;) {
            Message m;
            if (!message_receive(MPI_ANY_SOURCE, MPI_ANY_TAG, &m)) {
                pause_s(2e-4);
                continue;
            }
            free(m.bytes);
            n_left -= m.tag == TAG_LEFT;
        }
        is_whole = n_left == 0;
    }
    if (!is_whole)
        MPI_Abort(MPI_COMM_WORLD, exit_code);
    MPI_Finalize();
}

void cluster_disband(void)
{
    cluster_leave(status_exit_code(STATUS_INTERNAL)); /* of ranks that do not end */
}

const Executor *cluster_executor(size_t *n)
{
    int is_over, n_ranks = 1;
    MPI_Finalized(&is_over);
    *n = !is_over && rank_of(&n_ranks) == 0 ? n_ranks - 1 : 0;
    return *n > 0 ? &EXECUTOR_RANKS : NULL;
}
