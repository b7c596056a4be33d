# Two commands for a newcomer: `make fly` and `make test`. `make help` lists the rest.
PYTHON ?= python3
VENV   ?= .venv
ARGS   ?=

PINS       := $(filter-out requirements/bench.txt,$(wildcard requirements/*.txt))
INTERFACES := ros2_ws/src/drone_interfaces \
              ros2_ws/underlay/tf2_msgs ros2_ws/underlay/simulation_interfaces
SOURCES    := $(shell find $(INTERFACES:%=%/) -type f -not -name '*.py' -not -name '*.pyc')
RUN        := $(VENV)/bin/python

# A sourced ROS would bring a second copy of the libraries that the environment has.
unexport PYTHONPATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH

.DEFAULT_GOAL := help
.PHONY: help fly build test check bench hard-cases assets figures accuracy lock clean

help:  ## this list
	@sed -n 's/^\([a-z-]*\):.*##  *\(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 18

fly: build  ## fly the island; options: make fly ARGS="--help"
	@$(RUN) ros2_ws/start.py $(ARGS)

build: $(VENV)/built  ## the environment, the message packages and the assets

test: build  ## style, types, architecture, unit and integration tests
	@$(RUN) -m pytest --numprocesses 2 --dist loadfile

assets: build  ## rebuild models and textures from their scripts, byte for byte
	@cd assets && "$(CURDIR)/$(RUN)" -m make

check: build  ## style, types and architecture only
	@$(RUN) -m pytest test/test_repository.py

bench: $(VENV)/peers  ## collisions, motion, pictures and the whole graph beside others; make bench ARGS="--quick"
	@$(RUN) -m bench.collision $(ARGS)
	@$(RUN) -m bench.dynamics $(ARGS)
	@$(RUN) -m bench.render $(ARGS)
	@$(RUN) -m bench.graph $(ARGS)

hard-cases: $(VENV)/peers  ## millions of hard pairs, hours of motion (ten minutes); make hard-cases ARGS="--count 1000"
	@$(RUN) -m bench.hard_cases $(ARGS); reached=$$?; $(RUN) -m figures.hard_cases.motion; exit $$reached

figures: build  ## draw the pictures and films of the documentation anew
	@$(RUN) -m figures.render.stills
	@$(RUN) -m figures.render.island_film
	@$(RUN) -m figures.render.levels_film
	@$(RUN) -m figures.hard_cases.collision
	@$(RUN) -m figures.hard_cases.motion
	@$(RUN) -m figures.effects
	@$(RUN) -m figures.flight_models

accuracy: $(VENV)/peers  ## measure what accuracy costs: tables, numbers and plots, in five minutes
	@$(RUN) -m bench.accuracy.collision
	@$(RUN) -m figures.accuracy.collision
	@$(RUN) -m bench.accuracy.motion
	@$(RUN) -m figures.accuracy.motion

lock: $(VENV)/peers  ## write requirements/lock.txt anew from this environment
	@$(RUN) requirements/lock.py

clean:  ## remove the environment and everything that was built
	rm -rf $(VENV) ros2_ws/build ros2_ws/install ros2_ws/log

$(VENV)/pins: $(PINS) requirements/system.sh
	@sh requirements/system.sh $(PYTHON)
	@$(PYTHON) -m venv $(VENV)
	@echo "installing the pinned packages (about a minute) ..."
	@$(VENV)/bin/pip install --quiet --disable-pip-version-check --constraint requirements/lock.txt \
	    --requirement requirements/ros.txt --requirement requirements/run.txt --requirement requirements/dev.txt
	@touch $@

$(VENV)/peers: $(VENV)/built requirements/bench.txt
	@echo "installing what the benchmarks compare with ..."
	@$(VENV)/bin/pip install --quiet --disable-pip-version-check --constraint requirements/lock.txt \
	    --requirement requirements/bench.txt
	@touch $@

$(VENV)/built: $(VENV)/pins $(SOURCES) ros2_ws/build.sh
	@bash ros2_ws/build.sh $(VENV) $(INTERFACES)
	@touch $@
